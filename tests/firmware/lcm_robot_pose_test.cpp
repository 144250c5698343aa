// What is told of a robot whose laser is not in its middle, and hangs upside down.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "firmware/lcm/messages.hpp"

namespace odoless {
namespace {

// The laser is 0.5 m ahead of the robot's own point and looks to the left.
PoseRecord pose_of_hanging_laser() {
  PoseRecord record;
  record.map_T_scan = {12.0, 3.0, M_PI / 2.0};
  record.covariance = {1e-4, 0.0, 0.0, 0.0, 1e-4, 0.0, 0.0, 0.0, 4e-4};
  record.laser = {.x_m = 0.5, .yaw_rad = M_PI / 2.0, .is_flipped = true};
  return record;
}

constexpr Velocity kTurning{0.0, 0.0, 2.0};

TEST(RobotPose, IsOfTheRobotsOwnPoint) {
  bot_core::pose_t robot;
  to_message(pose_of_hanging_laser(), kTurning, robot);
  EXPECT_NEAR(robot.pos[0], 12.0, 1e-12);
  EXPECT_NEAR(robot.pos[1], 2.5, 1e-12);
  EXPECT_NEAR(robot.vel[0], 1.0, 1e-12) << "at 2 rad/s about the laser, which stands, half a metre ahead";
  EXPECT_NEAR(robot.vel[1], 0.0, 1e-12);
}

TEST(RobotPose, IsAsUncertainAsTheYawMakesIt) {
  pose_estimate_t estimate;
  to_message(pose_of_hanging_laser(), estimate);
  EXPECT_NEAR(estimate.pose[1], 2.5, 1e-12);
  EXPECT_NEAR(estimate.covariance[0], 1e-4 + 0.25 * 4e-4, 1e-12) << "across";
  EXPECT_NEAR(estimate.covariance[4], 1e-4, 1e-12) << "along";
  EXPECT_NEAR(estimate.covariance[2], 0.5 * 4e-4, 1e-12) << "more yaw, less of what is behind";
  EXPECT_EQ(estimate.covariance[8], 4e-4);
}

TEST(RobotPose, HasAStepOfTheRobot) {
  PoseRecord record = pose_of_hanging_laser();
  record.update_T_scan = {0.0, 0.0, M_PI / 2.0};  // about the laser
  pose_estimate_t estimate;
  to_message(record, estimate);
  EXPECT_NEAR(estimate.step[0], 0.5, 1e-12);
  EXPECT_NEAR(estimate.step[1], -0.5, 1e-12);
  EXPECT_EQ(estimate.step[2], M_PI / 2.0);
}

// The laser's own front looks along -x of the map; its own left, where the robot has its right, along y.
TEST(RobotPose, TakesTheScansOwnAxesToTheMap) {
  bot_core::pose_t laser;
  to_laser_message(pose_of_hanging_laser(), kTurning, laser);
  EXPECT_EQ(laser.pos[1], 3.0);
  EXPECT_EQ(laser.vel[0], 0.0);
  const Eigen::Quaterniond map_Q_laser(laser.orientation[0], laser.orientation[1], laser.orientation[2],
                                       laser.orientation[3]);
  EXPECT_TRUE((map_Q_laser * Eigen::Vector3d::UnitX()).isApprox(-Eigen::Vector3d::UnitX(), 1e-9));
  EXPECT_TRUE((map_Q_laser * Eigen::Vector3d::UnitY()).isApprox(Eigen::Vector3d::UnitY(), 1e-9));
}

}  // namespace
}  // namespace odoless
