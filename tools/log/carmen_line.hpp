#pragma once

#include <cstddef>
#include <optional>

#include "tools/log/fields.hpp"

namespace odoless {

/// Where a laser message of a CARMEN log has what; indices of fields, all of which exist.
struct CarmenLine {
  std::size_t ranges_begin = 0;
  std::size_t ranges = 0;
  std::size_t laser_pose_begin = 0;    ///< x, y, theta of the laser; for evaluation alone
  std::optional<std::size_t> stamp{};  ///< nothing when the message ends after its poses
  double start_angle_rad = 0.0;
  double angle_step_rad = 0.0;
  float no_return_m = 0.0F;
};

/// Lays out `FLASER n r1..rn x y theta odom_x odom_y odom_theta [ipc_timestamp host logger_timestamp]`.
/// 180 or 181 ranges are 1 deg apart, 360 or 361 half a degree, any other number spreads over 180 deg; the first is at
/// -90 deg. @throws DataError.
[[nodiscard]] CarmenLine lay_out_flaser(const Fields& fields);

/// Lays out `ROBOTLASER1 type start fov step max accuracy remission n r1..rn m remissions... laser pose, robot pose,
/// tv rv forward_safety side_safety turn_axis ipc_timestamp host logger_timestamp`. @throws DataError.
[[nodiscard]] CarmenLine lay_out_robotlaser(const Fields& fields);

}  // namespace odoless
