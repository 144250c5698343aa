// The pose graph as users see it: a loop that the odometry leaves open closes, places that look alike do not close one,
// and the same run gives the same bytes.
#include "core/graph/submap_graph.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <optional>
#include <vector>

#include "tests/core/graph/graph_drive.hpp"

namespace odoless {
namespace {

TEST(SubmapGraph, ClosesALoopThatTheOdometryLeavesOpen) {
  Drive run(ring(18.0, 10.0), {0.01, 0.0, 0.0006});
  run.drive(kRound);
  run.drive(kRound);
  const double odometry_m = run.worst_error_m(run.odom);
  run.graph.finish();
  EXPECT_GT(odometry_m, 0.8);
  EXPECT_GT(run.graph.counts().accepted, 5);
  EXPECT_LT(run.worst_error_m(run.graph.corrected(run.odom)), 0.3);
  // Where poses lack, those of some submaps' origins too, the rest is where it was, but for how far it is corrected.
  std::vector<StampedPose> some;
  std::vector<Pose2> true_poses;
  for (std::size_t i = 0; i < run.odom.size(); ++i) {
    if (i % 3 != 0) {
      some.push_back(run.odom[i]);
      true_poses.push_back(run.poses.front().inverse() * run.poses[i]);
    }
  }
  const std::vector<StampedPose> corrected = run.graph.corrected(some);
  for (std::size_t i = 0; i < some.size(); ++i) {
    ASSERT_LT(corrected[i].map_T_scan.distance_m(true_poses[i]), 0.35) << i;
    if (i > 0) {  // and nothing jumps
      const double step_m = corrected[i].map_T_scan.distance_m(corrected[i - 1].map_T_scan);
      ASSERT_LT(step_m, true_poses[i].distance_m(true_poses[i - 1]) + 0.1) << i;
    }
  }
  // and the newest pose is right at the time: that is what map_T_odom is for
  const Pose2 online = run.graph.map_T_odom() * run.odom.back().map_T_scan;
  EXPECT_LT(online.distance_m(run.poses.front().inverse() * run.poses.back()), 0.3);
}

TEST(SubmapGraph, TellsWhyAndHowFarItMovesTheRobot) {
  Drive run(ring(18.0, 10.0), {0.01, 0.0, 0.0006});
  run.drive({kRound[0], kRound[1], kRound[2], kRound[3]});
  EXPECT_TRUE(run.feed.corrections.empty()) << "without a loop closure";
  run.drive({kRound[3], kRound[0]});
  run.drive(kRound);
  std::int64_t loop_closures = 0;
  double farthest_m = 0.0;
  for (const auto& [said, before, after] : run.feed.corrections) {
    EXPECT_EQ(said.cause, CorrectionCause::kLoop);
    EXPECT_TRUE(std::ranges::any_of(run.graph.graph().constraints(),
                                    [&said = said](const Constraint& each) {
                                      return each.is_loop && each.from == said.reference && each.to == said.query &&
                                             each.weight > 0.0;
                                    }))
        << said.reference << ", " << said.query;
    EXPECT_NEAR(said.moved.x_m, after.x_m - before.x_m, 1e-9);
    EXPECT_NEAR(said.moved.y_m, after.y_m - before.y_m, 1e-9);
    EXPECT_NEAR(wrap_angle(said.moved.yaw_rad - (after.yaw_rad - before.yaw_rad)), 0.0, 1e-9);
    loop_closures += said.loop_closures;
    farthest_m = std::max(farthest_m, after.distance_m(before));
  }
  EXPECT_GT(loop_closures, 0);
  EXPECT_EQ(loop_closures, run.graph.counts().accepted - run.graph.counts().taken_out);
  EXPECT_GT(farthest_m, 0.4) << "when the loop is closed";
}

/// Three sides of the ring: no loop is closed.
struct OpenDrive : Drive {
  OpenDrive() : Drive(ring(18.0, 10.0), {0.01, 0.0, 0.0025}) {
    yaw_variance_rad2 = 9e-5;  // over 220 motions as much as the drift
  }

  void finish_with(std::optional<Pose2> filter_off) {
    drive({kRound[0], kRound[1]});
    filter = filter_off;
    drive({kRound[1], kRound[2], kRound[3]});
  }
  [[nodiscard]] Pose2 online() const { return graph.map_T_odom() * odom.back().map_T_scan; }
  [[nodiscard]] Pose2 truth() const { return poses.front().inverse() * poses.back(); }
};

TEST(SubmapGraph, FollowsTheFilterUntilALoopIsClosed) {
  OpenDrive run;
  run.finish_with(Pose2{});
  const double odometry_m = run.odom.back().map_T_scan.distance_m(run.truth());
  EXPECT_EQ(run.graph.counts().accepted, 0);
  EXPECT_GT(odometry_m, 1.0);
  EXPECT_LT(run.online().distance_m(run.truth()), 0.5 * odometry_m);
}

TEST(SubmapGraph, BelievesNoOdometryOverWhichTheRobotWasLost) {
  OpenDrive run;
  run.drive({kRound[0], kRound[1]});
  run.carry({kRound[1].x_m, kRound[1].y_m + 4.0, 1.5}, 5.0);
  run.drive({{kRound[1].x_m, kRound[1].y_m + 4.0}, kRound[2], kRound[3]});
  EXPECT_GT(run.odom.back().map_T_scan.distance_m(run.truth()), 3.0);
  EXPECT_LT(run.online().distance_m(run.truth()), 0.4);
}

TEST(SubmapGraph, IsNotDrawnAwayByAFilterThatIsElsewhere) {
  OpenDrive alone;
  alone.finish_with({});
  OpenDrive misled;
  misled.finish_with(Pose2{20.0, -5.0, 1.0});
  EXPECT_LT(misled.online().distance_m(alone.online()), 0.5);
}

TEST(SubmapGraph, ClosesNoLoopInAHotelCorridor) {
  for (const double scale : {0.0, 0.02, -0.02}) {
    Drive run(hotel(), {scale, 0.0, 0.0});
    run.drive({{1.0, 0.0}, {58.0, 0.0}, {1.0, 0.0}});
    run.graph.finish();
    for (const Constraint& each : run.graph.graph().constraints()) {
      if (!each.is_loop || each.weight < 0.1) {
        continue;
      }
      const auto truth = [&](int submap) {
        const std::int64_t stamp_ns = run.graph.submaps()[static_cast<std::size_t>(submap)].origin_stamp_ns;
        return run.poses[static_cast<std::size_t>(stamp_ns / 200'000'000)];
      };
      const Pose2 wrong = each.from_T_to.inverse() * (truth(each.from).inverse() * truth(each.to));
      EXPECT_LT(wrong.distance_m({}), 1.5) << "submaps " << each.from << " and " << each.to << ", drift " << scale;
    }
  }
}

TEST(SubmapGraph, TheSameRunGivesTheSameBytes) {
  const auto poses = [] {
    Drive run(ring(18.0, 10.0), {0.01, 0.0, 0.0006});
    run.drive(kRound);
    run.drive({kRound[0], kRound[1]});
    run.graph.finish();
    return run.graph.corrected(run.odom);
  };
  const std::vector<StampedPose> first = poses();
  const std::vector<StampedPose> second = poses();
  ASSERT_EQ(first.size(), second.size());
  EXPECT_EQ(std::memcmp(first.data(), second.data(), first.size() * sizeof(StampedPose)), 0);
}

TEST(SubmapGraph, StopsToGrowWhereItIsFullAndGoesOn) {
  GraphParams params;
  params.submaps_max = 16;
  params.keyframes_max = 64;
  SubmapGraph graph(params, {}, {}, 1);
  Feed feed(params);
  const SimulatedScene scene = ring(18.0, 10.0);
  Rng rng(1);
  Motion motion;
  for (int i = 0; i < 800; ++i) {
    if (i > 0) {
      motion = Motion::between(i, i + 1, {0.25, 0.0, 0.0});
      motion.odom_T_current = Pose2{0.25 * i, 0.0, 0.0};
    }
    feed.add(sweep(scene, {.beams = 61}, {-10.5, -6.5, 0.0}, rng, i), motion, graph);
  }
  graph.finish();
  EXPECT_LE(graph.submaps().size(), 16U);
  EXPECT_LE(graph.keyframes().size(), 64);
}

}  // namespace
}  // namespace odoless
