#pragma once

#include <cstdint>

#include "core/geometry/pose2.hpp"

namespace odoless {

/// What a scan match says about the motion between two scans.
///
/// Frames: `previous_T_current` takes coordinates in the current scan's frame to the previous one's.
struct MotionIncrement {
  std::int64_t from_stamp_ns = 0;
  std::int64_t to_stamp_ns = 0;
  Pose2 previous_T_current;
  double sd_x_m = 0.0;  ///< deviations of the match, in the previous scan's frame; 0: the motion model's law alone
  double sd_y_m = 0.0;
  double sd_yaw_rad = 0.0;
};

}  // namespace odoless
