#include "core/scan/scan_frame.hpp"

#include <algorithm>
#include <cmath>

namespace odoless {
namespace {

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
    directions_[static_cast<std::size_t>(directions_valid_)] = {std::cos(beam_rad), std::sin(beam_rad)};
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

}  // namespace odoless
