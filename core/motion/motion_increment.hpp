#pragma once

#include <cstdint>

#include "core/geometry/pose2.hpp"
#include "core/motion/motion_error.hpp"

namespace odoless {

/// What a scan match says about the motion between two scans.
///
/// Frames: `previous_T_current` takes coordinates in the current scan's frame to the previous one's.
struct MotionIncrement {
  std::int64_t from_stamp_ns = 0;
  std::int64_t to_stamp_ns = 0;
  Pose2 previous_T_current;
  MotionError error{};  ///< of the match; without noise: the motion model's law alone
};

}  // namespace odoless
