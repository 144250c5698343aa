#include "core/graph/keyframe_store.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/check.hpp"

namespace odoless {
namespace {

constexpr double kUnit_m = 0.004;
constexpr std::uint16_t kInvalid = 0;
constexpr std::uint16_t kNoReturn = 0xffff;
constexpr float kNoReturn_m = 1000.0F;

std::uint16_t code_of(const ScanFrame& scan, int beam) {
  switch (scan.state(beam)) {
    case BeamState::kReturn: {
      const double units = std::round(scan.range_m(beam) / kUnit_m);
      return units < kNoReturn ? static_cast<std::uint16_t>(std::max(1.0, units)) : kNoReturn;
    }
    case BeamState::kNoReturn:
      return kNoReturn;
    case BeamState::kInvalid:
      break;
  }
  return kInvalid;
}

float range_of(std::uint16_t code) { return code == kNoReturn ? kNoReturn_m : static_cast<float>(code * kUnit_m); }

// Of two returns at one angle the nearer one hides the other.
std::uint16_t nearer(std::uint16_t a, std::uint16_t b) {
  return a == kInvalid ? b : b == kInvalid ? a : std::min(a, b);
}

}  // namespace

int KeyframeStore::add(const ScanFrame& scan, const Pose2& submap_T_scan) {
  ODOLESS_CHECK(!full());
  const int stride = (scan.size() + beams_max_ - 1) / beams_max_;
  Keyframe keyframe{.stamp_ns = scan.stamp_ns(),
                    .submap_T_scan = submap_T_scan,
                    .start_angle_rad = scan.angle_rad(0),
                    .angle_step_rad = scan.angle_step_rad() * stride,
                    .first_range = ranges_.size(),
                    .beams = (scan.size() + stride - 1) / stride};
  ranges_.resize(ranges_.size() + static_cast<std::size_t>(keyframe.beams), kInvalid);
  for (int i = 0; i < scan.size(); i += stride) {
    const Point2 direction = scan.direction(i);
    const double off_rad = wrap_angle(std::atan2(direction.y_m, direction.x_m) - scan.angle_rad(i));
    const int bin = i / stride + static_cast<int>(std::lround(off_rad / keyframe.angle_step_rad));
    if (bin >= 0 && bin < keyframe.beams) {
      std::uint16_t& code = ranges_[keyframe.first_range + static_cast<std::size_t>(bin)];
      code = nearer(code, code_of(scan, i));
    }
  }
  keyframes_.push_back(keyframe);
  return size() - 1;
}

double KeyframeStore::farthest_m(int index) const {
  std::uint16_t farthest = 0;
  for (int i = 0; i < (*this)[index].beams; ++i) {
    const std::uint16_t code = ranges_[(*this)[index].first_range + static_cast<std::size_t>(i)];
    farthest = code == kNoReturn ? farthest : std::max(farthest, code);
  }
  return farthest * kUnit_m;
}

void KeyframeStore::load(int index, int stride, ScanFrame& frame) const {
  const Keyframe& keyframe = (*this)[index];
  loaded_.clear();
  for (int i = 0; i < keyframe.beams; i += stride) {
    loaded_.push_back(range_of(ranges_[keyframe.first_range + static_cast<std::size_t>(i)]));
  }
  const RawScan raw{.stamp_ns = keyframe.stamp_ns,
                    .start_angle_rad = keyframe.start_angle_rad,
                    .angle_step_rad = keyframe.angle_step_rad * stride,
                    .no_return_m = kNoReturn_m,
                    .ranges_m = loaded_};
  ODOLESS_CHECK(frame.assign(raw) == Errc::kOk);
}

}  // namespace odoless
