#include "core/graph/keyframe.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "core/base/check.hpp"
#include "core/math/elementary.hpp"

namespace odoless {
namespace {

constexpr double kUnit_m = 0.004;
constexpr BeamCode kInvalid = 0;
constexpr BeamCode kNoReturn = 0xffff;

BeamCode code_of(const ScanFrame& scan, int beam) {
  switch (scan.state(beam)) {
    case BeamState::kReturn: {
      const double units = std::round(scan.range_m(beam) / kUnit_m);
      return units < kNoReturn ? static_cast<BeamCode>(std::max(1.0, units)) : kNoReturn;
    }
    case BeamState::kNoReturn:
      return kNoReturn;
    case BeamState::kInvalid:
      break;
  }
  return kInvalid;
}

// Of two returns at one angle the nearer one hides the other.
BeamCode nearer(BeamCode a, BeamCode b) { return a == kInvalid ? b : b == kInvalid ? a : std::min(a, b); }

int stride_of(int scan_beams, int beams_max) { return std::max(1, (scan_beams + beams_max - 1) / beams_max); }

}  // namespace

int keyframe_beams(int scan_beams, int beams_max) {
  const int stride = stride_of(scan_beams, beams_max);
  return (scan_beams + stride - 1) / stride;
}

void encode(const ScanFrame& scan, int beams_max, Keyframe& keyframe, std::span<BeamCode> codes) {
  const int stride = stride_of(scan.size(), beams_max);
  keyframe.stamp_ns = scan.stamp_ns();
  keyframe.start_angle_rad = scan.angle_rad(0);
  keyframe.angle_step_rad = scan.angle_step_rad() * stride;
  keyframe.beams = keyframe_beams(scan.size(), beams_max);
  ODOLESS_CHECK(codes.size() == static_cast<std::size_t>(keyframe.beams));
  std::fill(codes.begin(), codes.end(), kInvalid);
  for (int i = 0; i < scan.size(); i += stride) {
    const Point2 direction = scan.direction(i);
    const double off_rad = wrap_angle(math::atan2(direction.y_m, direction.x_m) - scan.angle_rad(i));
    const int at = i / stride + static_cast<int>(std::lround(off_rad / keyframe.angle_step_rad));
    if (at >= 0 && at < keyframe.beams) {
      BeamCode& code = codes[static_cast<std::size_t>(at)];
      code = nearer(code, code_of(scan, i));
    }
  }
}

float range_of(BeamCode code) { return code == kNoReturn ? kNoReturn_m : static_cast<float>(code * kUnit_m); }

}  // namespace odoless
