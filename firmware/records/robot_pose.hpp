#pragma once

#include <array>

#include "firmware/records/records.hpp"

namespace odoless {

/// A pose as the outside is told it: of the robot's own point, not of the laser on it.
struct RobotPose {
  Pose2 map_T_robot{};
  Pose2 update_T_robot{};              ///< motion of the robot since the filter's last update
  std::array<double, 9> covariance{};  ///< of map_T_robot over (x_m, y_m, yaw_rad), map axes
};

/// The very same numbers where the laser is in the robot's middle. Pure.
[[nodiscard]] RobotPose robot_pose_of(const PoseRecord& pose);

}  // namespace odoless
