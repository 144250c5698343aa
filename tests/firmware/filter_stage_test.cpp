#include "firmware/stages/filter_stage.hpp"

#include <gtest/gtest.h>

#include "tests/support/simulated_room.hpp"

namespace odoless {
namespace {

RobotParams small_robot() {
  RobotParams params;
  params.slam.low.particles = 5;
  return params;
}

Motion first_motion(const Pose2& odom_T_scan) {
  Motion motion = Motion::between(0, 0, odom_T_scan);
  motion.odom_T_current = odom_T_scan;
  return motion;
}

TEST(FilterStage, BeginsWhereTheOdometryIsWhenItsFirstScansWereLost) {
  FilterStage stage(small_robot(), 1);
  SimulatedRoom room(4);
  room.step();
  const Pose2 odom_T_scan{0.3, -0.2, 0.1};
  const FilterStep step = stage.process(room.scan(), first_motion(odom_T_scan));
  EXPECT_LT(step.map_T_scan.distance_m(odom_T_scan), 1e-9);
  EXPECT_NEAR(step.map_T_scan.yaw_rad, 0.1, 1e-9);
}

TEST(FilterStage, BeginsInTheMiddleOfItsGridWhenTheOdometryIsFarAway) {
  FilterStage stage(small_robot(), 1);
  SimulatedRoom room(4);
  room.step();
  EXPECT_LT(stage.process(room.scan(), first_motion({500.0, 0.0, 0.0})).map_T_scan.distance_m({}), 1e-9);
}

TEST(FilterStage, TakesTheFirstScanAfterAResetFromWhereItWasTold) {
  FilterStage stage(small_robot(), 1);
  SimulatedRoom room(4);
  room.step();
  const Pose2 start{2.0, 1.0, 0.5};
  stage.reset(start);
  EXPECT_LT(stage.process(room.scan(), first_motion({0.3, 0.0, 0.0})).map_T_scan.distance_m(start), 1e-9);
}

}  // namespace
}  // namespace odoless
