#include "core/cloud/level_scan.hpp"

#include <algorithm>
#include <cmath>

#include "core/math/elementary.hpp"

namespace odoless {

LevelScan::LevelScan(const TiltMount& mount, const LevelParams& params, int beams_max)
    : params_(params), projector_(mount, beams_max), ranges_m_(static_cast<std::size_t>(beams_max)) {
  ODOLESS_CHECK(parameters_in_range(params));
}

// Into the beam whose direction is nearest; of several ends in one beam the nearest hides the others.
void LevelScan::enter(const BeamPoint& point, const ScanFrame& scan) {
  constexpr double kTurnRad = 2.0 * std::numbers::pi;
  const double step_rad = std::abs(scan.angle_step_rad());
  const double bearing_rad = math::atan2(point.y_m, point.x_m);
  const double from_first_rad = std::copysign(1.0, scan.angle_step_rad()) * (bearing_rad - scan.angle_rad(0));
  const double turn_rad = from_first_rad + step_rad / 2.0;
  const double positive_rad = turn_rad - kTurnRad * std::floor(turn_rad / kTurnRad);
  const double beam = std::floor(positive_rad / step_rad);
  if (beam < scan.size()) {
    float& range_m = ranges_m_[static_cast<std::size_t>(beam)];
    const auto found_m = static_cast<float>(math::hypot(point.x_m, point.y_m));
    range_m = range_m > 0.0F ? std::min(range_m, found_m) : found_m;
  }
}

Result<std::span<const float>> LevelScan::make(const ScanFrame& scan, std::span<const double> tilts_rad) {
  const bool is_level = std::all_of(tilts_rad.begin(), tilts_rad.end(), [this](double tilt_rad) {
    return std::abs(tilt_rad) <= params_.tilt_max_rad;  // false for NaN
  });
  if (!is_level) {
    return Errc::kTooFewReturns;
  }
  const std::span<float> ranges_m(ranges_m_.data(), static_cast<std::size_t>(scan.size()));
  std::fill(ranges_m.begin(), ranges_m.end(), 0.0F);
  int returns = 0;
  for (const BeamPoint& point : projector_.project(scan, tilts_rad, {})) {
    const double above_m = point.z_m - projector_.mount().level_height_m();
    if (above_m >= -params_.below_m && above_m <= params_.above_m) {
      enter(point, scan);
      ++returns;
    }
  }
  if (returns < params_.returns_min) {
    return Errc::kTooFewReturns;
  }
  return std::span<const float>(ranges_m);
}

}  // namespace odoless
