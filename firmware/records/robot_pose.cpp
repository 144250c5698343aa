#include "firmware/records/robot_pose.hpp"

#include <Eigen/Core>

namespace odoless {
namespace {

/// The robot's own point swings about the laser as the yaw changes.
std::array<double, 9> moved(const std::array<double, 9>& covariance, const Point2& scan_p_robot_map) {
  Eigen::Matrix3d swing = Eigen::Matrix3d::Identity();
  swing(0, 2) = -scan_p_robot_map.y_m;
  swing(1, 2) = scan_p_robot_map.x_m;
  std::array<double, 9> out{};
  // Symmetric, so that rows and columns are the same.
  Eigen::Map<Eigen::Matrix3d>(out.data()) =
      swing * Eigen::Map<const Eigen::Matrix3d>(covariance.data()) * swing.transpose();
  return out;
}

}  // namespace

RobotPose robot_pose_of(const PoseRecord& pose) {
  const LaserPlace& laser = pose.laser;
  if (laser.is_in_middle()) {
    return {pose.map_T_scan, pose.update_T_scan, pose.covariance};
  }
  const Pose2 map_T_robot = laser.robot_of(pose.map_T_scan);
  const Point2 offset{map_T_robot.x_m - pose.map_T_scan.x_m, map_T_robot.y_m - pose.map_T_scan.y_m};
  return {map_T_robot, laser.robot_of(Pose2{laser.x_m, laser.y_m, 0.0} * pose.update_T_scan),
          moved(pose.covariance, offset)};
}

}  // namespace odoless
