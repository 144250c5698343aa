#include "tools/log/straightness.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>

#include "core/geometry/pose2.hpp"
#include "core/math/elementary.hpp"

namespace odoless {
namespace {

constexpr std::size_t kScans_max = 300;
constexpr std::size_t kBeams_min = 6;  // of a stretch
constexpr float kRange_min_m = 0.3F;   // nearer, noise alone bends
constexpr float kRange_max_m = 30.0F;

/// Returns without a jump from one to the next: of one surface, as far as can be told.
bool is_one_surface(std::span<const float> ranges_m, float no_return_m) {
  for (std::size_t i = 0; i < ranges_m.size(); ++i) {
    const float range_m = ranges_m[i];
    if (!(range_m > kRange_min_m && range_m < std::min(no_return_m, kRange_max_m))) {
      return false;
    }
    if (i > 0 && std::abs(range_m - ranges_m[i - 1]) > 0.05F + 0.1F * ranges_m[i - 1]) {
      return false;
    }
  }
  return true;
}

/// Curvature of a parabola through the stretch along its chord, times its distance.
double bend(std::span<const float> ranges_m, double step_rad) {
  const std::size_t last = ranges_m.size() - 1;
  const auto point = [&](std::size_t i) {
    const double angle_rad = (static_cast<double>(i) - 0.5 * static_cast<double>(last)) * step_rad;
    return Point2{ranges_m[i] * math::cos(angle_rad), ranges_m[i] * math::sin(angle_rad)};
  };
  const Point2 first = point(0);
  const Point2 chord{point(last).x_m - first.x_m, point(last).y_m - first.y_m};
  const double length_m = std::max(math::hypot(chord.x_m, chord.y_m), 1e-6);
  // Moments of u, along the chord, -0.5 to 0.5, and of v, across it, over u: all by the length.
  std::array<double, 5> powers{};
  std::array<double, 3> products{};
  double range_m = 0.0;
  for (std::size_t i = 0; i <= last; ++i) {
    const Point2 p{point(i).x_m - first.x_m, point(i).y_m - first.y_m};
    const double u = (p.x_m * chord.x_m + p.y_m * chord.y_m) / (length_m * length_m) - 0.5;
    const double v = (p.y_m * chord.x_m - p.x_m * chord.y_m) / (length_m * length_m);
    double power = 1.0;
    for (std::size_t k = 0; k < powers.size(); ++k, power *= u) {
      powers[k] += power;
      if (k < products.size()) {
        products[k] += power * v;
      }
    }
    range_m += ranges_m[i];
  }
  const auto determinant = [](const std::array<double, 3>& a, const std::array<double, 3>& b,
                              const std::array<double, 3>& c) {
    return a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
  };
  const double all = determinant({powers[0], powers[1], powers[2]}, {powers[1], powers[2], powers[3]},
                                 {powers[2], powers[3], powers[4]});
  const double square = determinant({powers[0], powers[1], powers[2]}, {powers[1], powers[2], powers[3]}, products);
  return 2.0 * square / all / length_m * range_m / static_cast<double>(ranges_m.size());
}

}  // namespace

Straightness straightness(const ScanLog& log, double factor, double stretch_rad) {
  constexpr double kStraight = 0.15;  // bend that counts for half
  Straightness out;
  const std::size_t scan_step = log.scans.size() / kScans_max + 1;
  for (std::size_t i = 0; i < log.scans.size(); i += scan_step) {
    const LogScan& scan = log.scans[i];
    const double step_rad = std::abs(scan.angle_step_rad);
    const double wanted = std::min(stretch_rad / step_rad, static_cast<double>(scan.ranges_m.size()));
    const std::size_t beams = std::max(kBeams_min, static_cast<std::size_t>(wanted)) + 1;
    for (std::size_t begin = 0; begin + beams <= scan.ranges_m.size(); begin += beams / 2) {
      const std::span<const float> ranges_m(scan.ranges_m.data() + begin, beams);
      if (is_one_surface(ranges_m, scan.no_return_m)) {
        const double bent = bend(ranges_m, factor * step_rad) / kStraight;
        const double straight = 1.0 / (1.0 + bent * bent);
        out.share += std::isfinite(straight) ? straight : 0.0;
        ++out.stretches;
      }
    }
  }
  out.share /= static_cast<double>(std::max<std::size_t>(out.stretches, 1));
  return out;
}

double straight_step_factor(const ScanLog& log) {
  constexpr double kWide_rad = 48.0 * std::numbers::pi / 180.0;  // of what is told: half of it, if the step is half
  constexpr double kClearly = 1.5;
  constexpr double kShare_min = 0.15;
  constexpr std::size_t kStretches_min = 100;
  double best_factor = 1.0;
  double best_gain = kClearly;
  for (const double factor : {0.5, 2.0 / 3.0, 0.75, 4.0 / 3.0, 1.5, 2.0}) {
    const double stretch_rad = factor < 1.0 ? kWide_rad : 0.5 * kWide_rad;
    const Straightness told = straightness(log, 1.0, stretch_rad);
    const Straightness other = straightness(log, factor, stretch_rad);
    const double gain = other.share / std::max(told.share, 1e-3);
    if (other.stretches >= kStretches_min && other.share >= kShare_min && gain > best_gain) {
      best_gain = gain;
      best_factor = factor;
    }
  }
  return best_factor;
}

}  // namespace odoless
