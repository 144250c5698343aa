#include "firmware/stages/filter_stage.hpp"

#include <gtest/gtest.h>

#include <utility>
#include <vector>

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

TEST(FilterStage, BeginsWhereTheOdometryIsHoweverFarAway) {
  FilterStage stage(small_robot(), 1);
  SimulatedRoom room(4);
  room.step();
  const Pose2 far{500'000.0, -20.0, 0.0};
  const FilterStep step = stage.process(room.scan(), first_motion(far));
  EXPECT_LT(step.map_T_scan.distance_m(far), 1e-6);
  EXPECT_EQ(step.report.outside_tiles, 0);
}

TEST(FilterStage, TakesTheFirstScanAfterAResetFromWhereItWasTold) {
  FilterStage stage(small_robot(), 1);
  SimulatedRoom room(4);
  room.step();
  const Pose2 start{2.0, 1.0, 0.5};
  stage.reset(start);
  EXPECT_LT(stage.process(room.scan(), first_motion({0.3, 0.0, 0.0})).map_T_scan.distance_m(start), 1e-9);
}

/// What a filter makes of a motion with a wrong turn, while the right one is its alternative.
FilterStep step_after_wrong_turn(double probability) {
  RobotParams params;
  params.slam.low.particles = 40;
  FilterStage stage(params, 1);
  SimulatedRoom room(4, 120);
  FilterStep step;
  Pose2 odom_T_scan;
  for (int i = 0; i < 60; ++i) {
    room.step();
    Motion motion = room.motion();
    motion.set_error(
        ErrorProcess::independent(motion.previous_T_current, Eigen::Vector3d(1e-5, 1e-5, 1e-6).asDiagonal()));
    if (i == 40) {
      motion.alternatives[0] = {motion.previous_T_current, 0.0, rows_of<3>(motion.covariance())};
      motion.alternative_count = 1;
      motion.previous_T_current = motion.previous_T_current * Pose2{0.0, 0.0, 0.6};
      motion.probability = probability;
    }
    odom_T_scan = odom_T_scan * motion.previous_T_current;
    motion.odom_T_current = odom_T_scan;
    step = stage.process(room.scan(), motion);
    EXPECT_TRUE(i >= 40 || step.placements == 0) << i;
  }
  EXPECT_LT(step.map_T_scan.distance_m(room.map_T_scan()), 0.3);
  EXPECT_NEAR(wrap_angle(step.map_T_scan.yaw_rad - room.map_T_scan().yaw_rad), 0.0, 0.05) << "the filter knows better";
  return step;
}

TEST(FilterStage, SaysThatTheRobotIsElsewhereWhereAStepMayHaveBeenWrong) {
  EXPECT_EQ(step_after_wrong_turn(0.9).placements, 1);
  EXPECT_EQ(step_after_wrong_turn(1.0).placements, 0) << "the filter turned, not the robot";
}

TEST(FilterStage, SaysThatTheRobotIsElsewhereWhereItWasTold) {
  FilterStage stage(small_robot(), 1);
  SimulatedRoom room(4);
  room.step();
  EXPECT_EQ(stage.process(room.scan(), first_motion({})).placements, 0);
  stage.set_pose({1.0, 0.0, 0.0});
  EXPECT_EQ(stage.process(Motion{}).placements, 1);
}

/// The last step of a filter that is lost, finds its place nowhere and goes on.
FilterStep step_after_going_on(bool is_in_graph) {
  RobotParams params = small_robot();
  params.graph.enabled = is_in_graph;
  params.recovery.tracking.updates_min = 5;
  params.recovery.search.found_fit = 1.0;
  params.recovery.search.resume_after_s = 1.0;
  FilterStage stage(params, 1);
  SimulatedRoom room(4, 120);
  FilterStep step;
  bool was_lost = false;
  for (int i = 0; i < 200; ++i) {
    room.step();
    Motion motion = room.motion();
    motion.set_error(
        ErrorProcess::independent(motion.previous_T_current, Eigen::Vector3d(1e-5, 1e-5, 1e-6).asDiagonal()));
    motion.probability = i == 60 ? 0.05 : 1.0;
    step = stage.process(room.scan(), motion);
    was_lost = was_lost || step.tracking == Tracking::kLost;
    EXPECT_EQ(step.unconfirmed, was_lost && step.tracking != Tracking::kLost ? 1 : 0) << i;
  }
  EXPECT_TRUE(was_lost);
  return step;
}

TEST(FilterStage, LeavesItToThePoseGraphWhetherThePoseIsRightWhereItWentOnWithoutBeingFound) {
  const FilterStep beside_graph = step_after_going_on(true);
  EXPECT_EQ(beside_graph.tracking, Tracking::kSure);
  EXPECT_GT(beside_graph.probability, 0.9);
  const FilterStep alone = step_after_going_on(false);
  EXPECT_EQ(alone.tracking, Tracking::kDoubtful);
  EXPECT_LE(alone.probability, PoseEstimate::kUnconfirmed);
}

/// Steps of a stage that gets the motions of lost scans one by one, or added up as a full queue does, of which some are
/// `flags`.
std::vector<FilterStep> steps_with_lost_scans(bool added_up, MotionFlag flag, bool value) {
  RobotParams params = small_robot();
  params.gate.distance_m = 0.0;
  params.recovery.tracking.updates_min = 5;
  FilterStage stage(params, 1);
  SimulatedRoom room(4, 120);
  std::vector<FilterStep> steps;
  Motion waiting;
  for (int i = 0; i < 120; ++i) {
    room.step();
    Motion motion = room.motion();
    motion.odom_T_current = room.map_T_scan();
    motion.weak_information_1_m2 = 100.0;
    motion.set_error(
        ErrorProcess::independent(motion.previous_T_current, Eigen::Vector3d(1e-5, 1e-5, 1e-6).asDiagonal()));
    if (i == 91) {
      motion.set(flag, value);
    }
    const bool is_lost = i % 5 == 1 || i % 5 == 2;
    if (added_up) {
      waiting = waiting.then(motion);
    } else if (is_lost) {
      static_cast<void>(stage.process(motion));
    }
    if (!is_lost) {
      steps.push_back(stage.process(room.scan(), added_up ? waiting : motion));
      waiting = Motion{};
    }
  }
  return steps;
}

class FilterStageWithLostScans : public ::testing::TestWithParam<std::pair<MotionFlag, bool>> {};

TEST_P(FilterStageWithLostScans, ComposedMotionsAreWhatTheirPartsAre) {
  const auto [flag, value] = GetParam();
  const std::vector<FilterStep> apart = steps_with_lost_scans(false, flag, value);
  const std::vector<FilterStep> added_up = steps_with_lost_scans(true, flag, value);
  bool doubted = false;
  for (std::size_t i = 0; i < apart.size(); ++i) {
    ASSERT_LT(apart[i].map_T_scan.distance_m(added_up[i].map_T_scan), 1e-9) << i;
    ASSERT_NEAR(apart[i].map_T_scan.yaw_rad, added_up[i].map_T_scan.yaw_rad, 1e-9) << i;
    ASSERT_EQ(apart[i].tracking, added_up[i].tracking) << i;
    ASSERT_EQ(apart[i].updated, added_up[i].updated) << i;
    ASSERT_NEAR(apart[i].fit, added_up[i].fit, 1e-6) << i;
    doubted = doubted || apart[i].tracking != Tracking::kSure;
  }
  EXPECT_EQ(doubted, flag == kJolted) << "what befell a lost scan counts";
}

INSTANTIATE_TEST_SUITE_P(All, FilterStageWithLostScans,
                         ::testing::Values(std::pair{kConverged, true}, std::pair{kJolted, true},
                                           std::pair{kRejected, true}, std::pair{kMatched, false}));

}  // namespace
}  // namespace odoless
