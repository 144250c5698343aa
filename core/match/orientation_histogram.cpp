#include "core/match/orientation_histogram.hpp"

#include <algorithm>
#include <cmath>

#include "core/math/elementary.hpp"

namespace odoless {
namespace {

constexpr double kSpacing_min_m = 0.02;
constexpr double kTiny = 1e-12;        // keeps every angle possible
constexpr double kGap_spacings = 5.0;  // farther apart, two returns are not on one surface

std::size_t bin_of(double angle_rad) {
  const double turns = angle_rad / (2.0 * std::numbers::pi);
  const auto bin = static_cast<std::size_t>((turns - std::floor(turns)) * OrientationHistogram::kBins);
  return std::min(bin, OrientationHistogram::kBins - 1);
}

}  // namespace

void OrientationHistogram::add(const ScanFrame& scan, double yaw_rad, double spacing_m) {
  spacing_m = std::max(spacing_m, kSpacing_min_m);  // nearer points have the direction of their noise
  const double spacing_m2 = spacing_m * spacing_m;
  const double gap_m2 = kGap_spacings * kGap_spacings * spacing_m2;
  Point2 last{};
  bool has_last = false;
  for (int i = 0; i < scan.size(); ++i) {
    if (!scan.is_return(i)) {
      continue;
    }
    const Point2 p = scan.point(i);
    const double dx = p.x_m - last.x_m;
    const double dy = p.y_m - last.y_m;
    const double length_m2 = dx * dx + dy * dy;
    if (has_last && length_m2 < spacing_m2) {
      continue;
    }
    if (has_last && length_m2 < gap_m2) {
      bins_[bin_of(math::atan2(dy, dx) + yaw_rad)] += static_cast<float>(std::sqrt(length_m2));
    }
    last = p;
    has_last = true;
  }
}

void OrientationHistogram::smooth() {
  const std::array<float, kBins> old = bins_;
  for (std::size_t i = 0; i < kBins; ++i) {
    bins_[i] = 0.25F * old[(i + kBins - 1) % kBins] + 0.5F * old[i] + 0.25F * old[(i + 1) % kBins];
  }
}

double OrientationHistogram::correlation(const OrientationHistogram& other, int shift) const {
  constexpr auto kCount = static_cast<int>(kBins);
  const auto turned = static_cast<std::size_t>(((shift % kCount) + kCount) % kCount);
  float sum = 0.0F;
  for (std::size_t i = 0; i < kBins; ++i) {
    const std::size_t j = i + turned;
    sum += other.bins_[i] * bins_[j < kBins ? j : j - kBins];
  }
  return static_cast<double>(sum);
}

void AngleProposal::rebuild(const OrientationHistogram& reference, const OrientationHistogram& scan, double centre_rad,
                            double half_range_rad, double floor_share) {
  constexpr double kBin_rad = OrientationHistogram::kBin_rad;
  constexpr auto kMost = static_cast<int>(OrientationHistogram::kBins);
  const int first = static_cast<int>(std::floor((centre_rad - half_range_rad) / kBin_rad));
  const int last = static_cast<int>(std::ceil((centre_rad + half_range_rad) / kBin_rad));
  steps_ = std::clamp(last - first, 1, kMost);
  first_rad_ = first * kBin_rad - centre_rad;
  step_rad_ = kBin_rad;
  double sum = 0.0;
  double least = reference.correlation(scan, first);
  for (int i = 0; i < steps_; ++i) {
    const double value = reference.correlation(scan, first + i);
    cumulative_[static_cast<std::size_t>(i) + 1] = value;
    least = std::min(least, value);
  }
  for (int i = 1; i <= steps_; ++i) {
    cumulative_[static_cast<std::size_t>(i)] -= least;
    sum += cumulative_[static_cast<std::size_t>(i)];
  }
  const double even_value = floor_share * (sum > 0.0 ? sum : 1.0) / steps_ + kTiny;
  for (int i = 1; i <= steps_; ++i) {
    const auto at = static_cast<std::size_t>(i);
    cumulative_[at] = cumulative_[at - 1] + (1.0 - floor_share) * cumulative_[at] + even_value;
  }
}

double AngleProposal::offset_rad(double fraction) const {
  const auto begin = cumulative_.begin();
  const double target = fraction * cumulative_[static_cast<std::size_t>(steps_)];
  const auto above = std::upper_bound(begin + 1, begin + steps_, target);
  const auto bin = static_cast<double>(above - begin - 1);
  const double low = *(above - 1);
  const double rise = *above - low;
  return first_rad_ + (bin - 0.5 + std::clamp((target - low) / rise, 0.0, 1.0)) * step_rad_;
}

}  // namespace odoless
