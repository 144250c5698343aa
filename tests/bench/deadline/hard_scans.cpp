#include "tests/bench/deadline/hard_scans.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "core/base/check.hpp"

namespace odoless {
namespace {

constexpr double kFov_rad = 1.5 * std::numbers::pi;
constexpr double kNoise_sd_m = 0.01;

double to_circle_m(const Pose2& map_T_scan, double angle_rad, double radius_m) {
  const double along_m = map_T_scan.x_m * std::cos(angle_rad) + map_T_scan.y_m * std::sin(angle_rad);
  const double off_m2 = map_T_scan.x_m * map_T_scan.x_m + map_T_scan.y_m * map_T_scan.y_m;
  return -along_m + std::sqrt(along_m * along_m + radius_m * radius_m - off_m2);
}

double to_hall_m(const Pose2& map_T_scan, double angle_rad) {
  constexpr double kHalf_m = 29.0;
  const auto along_axis_m = [](double at_m, double direction) {
    return ((direction > 0.0 ? kHalf_m : -kHalf_m) - at_m) / direction;
  };
  return std::min(along_axis_m(map_T_scan.x_m, std::cos(angle_rad)), along_axis_m(map_T_scan.y_m, std::sin(angle_rad)));
}

}  // namespace

ScanFrame HardScanSource::next() {
  const double turn_rad = 0.04 * count_;
  const Pose2 map_T_scan{0.7 * std::cos(turn_rad) - 0.4, 0.7 * std::sin(turn_rad) - 1.2, wrap_angle(2.5 * turn_rad)};
  constexpr std::array kInTurn{HardScans::kRoom, HardScans::kNoise, HardScans::kFar, HardScans::kCircle};
  const HardScans kind = kind_ == HardScans::kAlternating ? kInTurn[rng_.below(kInTurn.size())] : kind_;
  return scan(kind, map_T_scan, ++count_ * kPeriod_ns);
}

ScanFrame HardScanSource::scan(HardScans kind, const Pose2& map_T_scan, std::int64_t stamp_ns) {
  const int beams = kind == HardScans::kFar ? 2048 : 1081;
  const SimulatedLaser laser{.beams = beams,
                             .start_angle_rad = -0.5 * kFov_rad,
                             .angle_step_rad = kFov_rad / (beams - 1),
                             .noise_sd_m = kNoise_sd_m};
  if (kind == HardScans::kRoom) {
    return sweep(room_, laser, map_T_scan, rng_, stamp_ns);
  }
  std::vector<float> ranges_m;
  for (int i = 0; i < beams; ++i) {
    const double angle_rad = map_T_scan.yaw_rad + laser.start_angle_rad + i * laser.angle_step_rad;
    ranges_m.push_back(range_m(kind, map_T_scan, angle_rad));
  }
  ScanFrame frame(ScanParams{});
  ODOLESS_CHECK(frame.assign({.stamp_ns = stamp_ns,
                              .start_angle_rad = laser.start_angle_rad,
                              .angle_step_rad = laser.angle_step_rad,
                              .ranges_m = ranges_m}) == Errc::kOk);
  return frame;
}

float HardScanSource::range_m(HardScans kind, const Pose2& map_T_scan, double angle_rad) {
  const double noise_m = kNoise_sd_m * rng_.normal();
  switch (kind) {
    case HardScans::kCircle:
      return static_cast<float>(to_circle_m(map_T_scan, angle_rad, 6.0) + noise_m);
    case HardScans::kNoise:
      return static_cast<float>(rng_.uniform(0.1, 30.0));
    case HardScans::kFoliage: {
      const double leaf_m = rng_.uniform(0.5, 20.0);  // one beam in ten goes through
      const double back_m = rng_.uniform() < 0.1 ? std::numeric_limits<double>::infinity() : 12.0 + noise_m;
      return static_cast<float>(std::min(leaf_m, back_m));
    }
    case HardScans::kOneRange:
      return 5.0F;
    case HardScans::kFar:
      return static_cast<float>(to_hall_m(map_T_scan, angle_rad) + noise_m);
    case HardScans::kAlternating:
    case HardScans::kRoom:
      break;
  }
  ODOLESS_CHECK(false);
}

}  // namespace odoless
