#include "core/scan/laser_mount.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/check.hpp"

namespace odoless {
namespace {

constexpr double kTurn_rad = 2.0 * std::numbers::pi;
constexpr double kEdge_rad = 1e-6;  // beams on the very edge of a sector are in it, whatever was rounded

/// Whether a bearing is on the way counter-clockwise from one to the other.
bool is_between(double bearing_rad, double from_rad, double to_rad) {
  const double wide_rad = to_rad - from_rad;
  if (wide_rad >= kTurn_rad) {
    return true;
  }
  const double width_rad = wide_rad < 0.0 ? wide_rad + kTurn_rad * std::ceil(-wide_rad / kTurn_rad) : wide_rad;
  return std::abs(wrap_angle(bearing_rad - from_rad - 0.5 * width_rad)) <= 0.5 * width_rad + kEdge_rad;
}

bool is_limited(const LaserMountParams& params) { return params.angle_max_rad - params.angle_min_rad < kTurn_rad; }

}  // namespace

LaserMount::LaserMount(const LaserMountParams& params, int beams_max)
    : params_(params),
      place_(LaserPlace::of(params)),
      has_sectors_(is_limited(params) || !params.ignore.empty()),
      beams_max_(static_cast<std::size_t>(beams_max)) {
  ODOLESS_CHECK(parameters_in_range(params));
  ignored_.reserve(beams_max_);
  ranges_m_.reserve(beams_max_);
}

bool LaserMount::is_ignored(double bearing_rad) const {
  return !is_between(bearing_rad, params_.angle_min_rad, params_.angle_max_rad) ||
         std::any_of(params_.ignore.begin(), params_.ignore.end(), [&](const AngleSector& sector) {
           return is_between(bearing_rad, sector.from_rad, sector.to_rad);
         });
}

bool LaserMount::fits(const RawScan& raw) const {
  return raw.ranges_m.size() <= beams_max_ && std::isfinite(raw.start_angle_rad) && std::isfinite(raw.angle_step_rad);
}

void LaserMount::look_at(const RawScan& raw) {
  const bool is_as_before = raw.start_angle_rad == start_angle_rad_ && raw.angle_step_rad == angle_step_rad_ &&
                            raw.ranges_m.size() == ignored_.size();
  if (is_as_before || !has_sectors_) {
    return;
  }
  start_angle_rad_ = raw.start_angle_rad;
  angle_step_rad_ = raw.angle_step_rad;
  ignored_.resize(raw.ranges_m.size());
  for (std::size_t i = 0; i < ignored_.size(); ++i) {
    const double laser_rad = raw.start_angle_rad + static_cast<double>(i) * raw.angle_step_rad;
    ignored_[i] = is_ignored(place_.bearing_rad(laser_rad)) ? 1 : 0;
  }
}

RawScan LaserMount::apply(const RawScan& raw) {
  if (!fits(raw)) {
    return raw;
  }
  RawScan out = raw;
  const auto beams = static_cast<std::int64_t>(raw.ranges_m.size());
  const std::int64_t last = beams - 1;
  if (raw.beam_period_ns == 0 && beams > 0) {
    out.beam_period_ns = params_.sweep_ns / beams;
    out.first_beam_ns = std::max<std::int64_t>(-last * out.beam_period_ns, 0);
  }
  if (place_.is_flipped && last >= 0) {
    out.start_angle_rad = -(raw.start_angle_rad + static_cast<double>(last) * raw.angle_step_rad);
    out.first_beam_ns += last * out.beam_period_ns;
    out.beam_period_ns = -out.beam_period_ns;
  }
  out.start_angle_rad += place_.yaw_rad;
  if (!has_sectors_ && !place_.is_flipped) {
    return out;
  }
  look_at(raw);
  ranges_m_.assign(raw.ranges_m.begin(), raw.ranges_m.end());
  for (std::size_t i = 0; has_sectors_ && i < ranges_m_.size(); ++i) {
    ranges_m_[i] = ignored_[i] != 0 ? std::numeric_limits<float>::quiet_NaN() : ranges_m_[i];
  }
  if (place_.is_flipped) {
    std::reverse(ranges_m_.begin(), ranges_m_.end());
  }
  out.ranges_m = ranges_m_;
  return out;
}

void LaserMount::mask(const RawScan& raw, std::span<float> ranges_m) {
  if (!has_sectors_ || !fits(raw)) {
    return;
  }
  look_at(raw);
  for (std::size_t i = 0; i < std::min(ranges_m.size(), ignored_.size()); ++i) {
    ranges_m[i] = ignored_[i] != 0 ? 0.0F : ranges_m[i];
  }
}

}  // namespace odoless
