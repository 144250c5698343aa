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

OdometryStep first_step(const Pose2& odom_T_scan) {
  OdometryStep step;
  step.odom_T_scan = step.previous_T_current = odom_T_scan;
  return step;
}

TEST(FilterStage, BeginsWhereTheOdometryIsWhenItsFirstScansWereLost) {
  FilterStage stage(small_robot(), 1);
  SimulatedRoom room(4);
  room.step();
  const Pose2 odom_T_scan{0.3, -0.2, 0.1};
  const FilterStep step = stage.process(room.scan(), first_step(odom_T_scan));
  EXPECT_LT(step.map_T_scan.distance_m(odom_T_scan), 1e-9);
  EXPECT_NEAR(step.map_T_scan.yaw_rad, 0.1, 1e-9);
}

TEST(FilterStage, BeginsInTheMiddleOfItsGridWhenTheOdometryIsFarAway) {
  FilterStage stage(small_robot(), 1);
  SimulatedRoom room(4);
  room.step();
  EXPECT_LT(stage.process(room.scan(), first_step({500.0, 0.0, 0.0})).map_T_scan.distance_m({}), 1e-9);
}

TEST(FilterStage, TakesTheFirstScanAfterAResetFromWhereItWasTold) {
  FilterStage stage(small_robot(), 1);
  SimulatedRoom room(4);
  room.step();
  const Pose2 start{2.0, 1.0, 0.5};
  stage.reset(start);
  EXPECT_LT(stage.process(room.scan(), first_step({0.3, 0.0, 0.0})).map_T_scan.distance_m(start), 1e-9);
}

}  // namespace
}  // namespace odoless
