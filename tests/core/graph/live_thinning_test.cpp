// A run that goes the same ways for longer than its world has room: it maps on, and is right all the time.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "core/graph/filter_in_world.hpp"
#include "core/graph/world_map.hpp"
#include "tests/core/graph/graph_drive.hpp"

namespace odoless {
namespace {

constexpr Pose2 kSlow_drift{0.004, 0.0, 0.0004};

/// Pools for some three rounds.
GraphParams few_submaps() {
  GraphParams params;
  params.submaps_max = 56;
  params.keyframes_max = 1024;
  params.constraints_max = 2048;
  return params;
}

struct LongDrive : Drive {
  explicit LongDrive(const GraphParams& params = few_submaps(), SimulatedScene scene = ring(18.0, 10.0))
      : Drive(std::move(scene), kSlow_drift, params) {}

  void drive_round() {
    for (std::size_t k = 0; k + 1 < kRound.size(); ++k) {
      drive({kRound[k], kRound[k + 1]});
      worst_m = rounds > 1 ? std::max(worst_m, error_m()) : 0.0;
      fullest = std::max(fullest, graph.used());
      was_localising = was_localising || graph.is_localising();
    }
    ++rounds;
  }
  [[nodiscard]] double error_m() const {
    return (graph.map_T_odom() * odom.back().map_T_scan).distance_m(poses.front().inverse() * poses.back());
  }

  int rounds = 0;
  double worst_m = 0.0;  ///< of the poses at the corners, at the time, once the first rounds are closed
  double fullest = 0.0;
  bool was_localising = false;
};

TEST(LiveThinning, ARobotThatGoesTheSameWaysNeverFillsItsWorld) {
  LongDrive run;
  for (int i = 0; i < 12; ++i) {
    run.drive_round();
  }
  EXPECT_GT(run.graph.thinnings(), 2);
  EXPECT_LT(run.fullest, 1.0);
  EXPECT_FALSE(run.was_localising);
  EXPECT_LT(run.worst_m, 0.3);
  EXPECT_TRUE(run.graph.is_in_world());
  run.graph.finish();
  EXPECT_LT(run.worst_error_m(run.graph.corrected(run.odom)), 0.3) << "where it drove by what was left out as well";
}

TEST(LiveThinning, HasTheSameMapAsARunWithRoom) {
  LongDrive run;
  LongDrive with_room(GraphParams{});
  for (int i = 0; i < 5; ++i) {
    run.drive_round();
    with_room.drive_round();
  }
  ASSERT_GT(run.graph.thinnings(), 0);
  ASSERT_EQ(with_room.graph.thinnings(), 0);
  const OccupancyMap thin = render_world(run.graph.world(), {}, {}, 0.1);
  const OccupancyMap whole = render_world(with_room.graph.world(), {}, {}, 0.1);
  const auto known = [](const OccupancyMap& map) {
    int cells = 0;
    for (int row = 0; row < map.height_cells; ++row) {
      for (int column = 0; column < map.width_cells; ++column) {
        cells += map.at(column, row) == OccupancyMap::kUnknown ? 0 : 1;
      }
    }
    return cells;
  };
  EXPECT_GT(known(thin), 0.97 * known(whole));
}

// Between one step of the work and the next.
TEST(LiveThinning, MovesNeitherTheRobotNorWhatStays) {
  LongDrive run;
  int thinnings = 0;
  FilterInWorld filter(few_submaps());
  for (int i = 0; i < 6; ++i) {
    for (std::size_t k = 0; k + 1 < kRound.size(); ++k) {
      run.drive({kRound[k], kRound[k + 1]});
      filter.update(run.graph);
      const Pose2 map_T_scan = filter.follow({}, run.odom.back().map_T_scan, 0, 0) * run.odom.back().map_T_scan;
      EXPECT_LT(map_T_scan.distance_m(run.graph.map_T_odom() * run.odom.back().map_T_scan), 1e-9);
      if (std::exchange(thinnings, run.graph.thinnings()) != run.graph.thinnings()) {
        EXPECT_LT(filter.drift()(0, 0), 0.3 * 0.3) << "loop closures hold it still";
      }
    }
  }
  ASSERT_GT(thinnings, 0);
  EXPECT_LT(run.feed.moved_by_thinning_m, 1e-9);
  PoseGraph solved = run.graph.graph();
  static_cast<void>(GraphSolver().solve(solved, 25));
  for (int i = 0; i < solved.size(); ++i) {
    EXPECT_LT(solved.pose(i).distance_m(run.graph.graph().pose(i)), 0.1) << i;
  }
}

TEST(LiveThinning, ChangesNothingWhereThereIsRoom) {
  LongDrive run(GraphParams{});
  run.drive_round();
  run.drive_round();
  EXPECT_EQ(run.graph.thinnings(), 0);
}

TEST(LiveThinning, AWorldThatIsGoneOnWithIsThinnedAsTheRunIs) {
  LongDrive before;
  before.drive_round();
  before.graph.finish();
  LongDrive run;
  ASSERT_TRUE(run.graph.resume(before.graph.world()));
  for (int i = 0; i < 4; ++i) {
    run.drive_round();
  }
  EXPECT_TRUE(run.graph.is_joined());
  EXPECT_GT(run.graph.thinnings(), 0);
  EXPECT_LT(run.graph.first_submap(), before.graph.submaps().size() / 3) << "what the world had is needless";
  EXPECT_EQ(run.graph.first_keyframe(), run.graph.submaps()[run.graph.first_submap()].first_keyframe);
  run.graph.finish();
  EXPECT_LT(run.worst_error_m(run.graph.corrected(run.odom)), 0.3);
}

// The robot localises in what is left, and maps on again.
TEST(LiveThinning, ThinnedAndGoneOverIsTheSameRun) {
  LongDrive run;
  for (int i = 0; i < 4; ++i) {
    run.drive_round();
  }
  ASSERT_GT(run.graph.thinnings(), 0);
  run.graph.go_over(WorldUse::kLocalise);
  run.drive_round();
  EXPECT_TRUE(run.graph.is_in_world());
  run.graph.go_over(WorldUse::kContinue);
  for (int i = 0; i < 3; ++i) {
    run.drive_round();
  }
  EXPECT_TRUE(run.graph.is_in_world());
  EXPECT_LT(run.worst_m, 0.3);
  run.graph.finish();
  EXPECT_LT(run.worst_error_m(run.graph.corrected(run.odom)), 0.3);
}

// A corridor out and back: nothing on the way out is needless until it is seen again, then all of it is full.
TEST(LiveThinning, AWorldOfWaysSeenOnceFillsAndStaysAsItIs) {
  GraphParams params = few_submaps();
  params.submaps_max = 16;
  LongDrive run(params);
  run.drive_round();
  EXPECT_EQ(run.graph.thinnings(), 0);
  EXPECT_TRUE(run.graph.is_localising());
  EXPECT_TRUE(run.graph.is_full());
}

}  // namespace
}  // namespace odoless
