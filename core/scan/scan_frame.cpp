#include "core/scan/scan_frame.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/math/elementary.hpp"

namespace odoless {
namespace {

// What no robot exceeds: a matcher that has lost itself may say anything.
constexpr double kDeskew_max_mps = 20.0;
constexpr double kDeskew_max_radps = 20.0;
constexpr double kDeskew_max_s = 0.5;

BeamState classify(float range_m, float no_return_m, const ScanParams& params) {
  if (std::isnan(range_m) || range_m <= 0.0F || range_m < params.range_min_m) {
    return BeamState::kInvalid;
  }
  return range_m >= no_return_m || range_m > params.range_max_m ? BeamState::kNoReturn : BeamState::kReturn;
}

}  // namespace

ScanFrame::ScanFrame(const ScanParams& params) : params_(params) {
  ODOLESS_CHECK(parameters_in_range(params));
  const auto capacity = static_cast<std::size_t>(params.beams_max);
  ranges_m_.resize(capacity);
  states_.resize(capacity);
  directions_.resize(capacity);
}

void ScanFrame::set_geometry(const RawScan& raw) {
  if (raw.start_angle_rad != start_angle_rad_ || raw.angle_step_rad != angle_step_rad_) {
    start_angle_rad_ = raw.start_angle_rad;
    angle_step_rad_ = raw.angle_step_rad;
    directions_valid_ = 0;
  }
  for (; directions_valid_ < size_; ++directions_valid_) {
    const double beam_rad = angle_rad(directions_valid_);
    directions_[static_cast<std::size_t>(directions_valid_)] = {math::cos(beam_rad), math::sin(beam_rad)};
  }
}

Errc ScanFrame::assign(const RawScan& raw) {
  if (raw.ranges_m.size() > ranges_m_.size()) {
    return Errc::kTooManyBeams;
  }
  if (!std::isfinite(raw.start_angle_rad) || !std::isfinite(raw.angle_step_rad) || raw.angle_step_rad == 0.0) {
    return Errc::kBadGeometry;
  }
  stamp_ns_ = raw.stamp_ns;
  time_ = ScanTime{.time_ns = raw.stamp_ns};
  unobserved_s_ = 0.0;
  first_beam_ns_ = raw.first_beam_ns;
  beam_period_ns_ = raw.beam_period_ns;
  deskewed_s_ = 0.0;
  deskewed_with_ = {};
  size_ = static_cast<int>(raw.ranges_m.size());
  set_geometry(raw);
  returns_ = 0;
  for (std::size_t i = 0; i < raw.ranges_m.size(); ++i) {
    states_[i] = classify(raw.ranges_m[i], raw.no_return_m, params_);
    const bool is_return = states_[i] == BeamState::kReturn;
    ranges_m_[i] = is_return ? raw.ranges_m[i] : 0.0F;
    returns_ += is_return ? 1 : 0;
  }
  return Errc::kOk;
}

// The turn changes the angle from beam to beam by the same, so that the beams stay evenly spaced but for the travel.
void ScanFrame::deskew(const Velocity2& velocity) {
  const double period_s = static_cast<double>(beam_period_ns_) * 1e-9;
  const bool is_credible = math::hypot(velocity.x_mps, velocity.y_mps) <= kDeskew_max_mps &&
                           std::abs(velocity.yaw_radps) <= kDeskew_max_radps;  // false for NaN
  const double first_s = static_cast<double>(first_beam_ns_) * 1e-9;
  const double sweep_s = std::abs(period_s) * size_;
  if (sweep_s <= 0.0 || sweep_s > kDeskew_max_s || !is_credible) {
    return;
  }
  const Velocity2 before = std::exchange(deskewed_with_, velocity);
  const bool is_again = std::exchange(deskewed_s_, sweep_s) > 0.0;
  start_angle_rad_ += (velocity.yaw_radps - before.yaw_radps) * first_s;
  angle_step_rad_ += (velocity.yaw_radps - before.yaw_radps) * period_s;
  for (int i = 0; i < size_; ++i) {
    const auto beam = static_cast<std::size_t>(i);
    const double time_s = first_s + i * period_s;
    const Point2 seen = point(i);
    const double measured_m =
        is_again ? math::hypot(seen.x_m - before.x_mps * time_s, seen.y_m - before.y_mps * time_s) : range_m(i);
    const double beam_rad = angle_rad(i);
    Point2& direction = directions_[beam];
    direction = {math::cos(beam_rad), math::sin(beam_rad)};
    if (!is_return(i)) {
      continue;
    }
    const Point2 p{measured_m * direction.x_m + velocity.x_mps * time_s,
                   measured_m * direction.y_m + velocity.y_mps * time_s};
    const double distance_m = math::hypot(p.x_m, p.y_m);
    if (distance_m > 0.0) {
      ranges_m_[beam] = static_cast<float>(distance_m);
      direction = {p.x_m / distance_m, p.y_m / distance_m};
    }
  }
  directions_valid_ = 0;  // the next scan's are others
}

}  // namespace odoless
