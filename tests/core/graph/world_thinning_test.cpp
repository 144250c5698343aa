// What newer visits make needless, and a world without it: the same place, the same map, less of it.
#include "core/graph/world_thinning.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "core/graph/world_map.hpp"
#include "core/slam/beam_model.hpp"
#include "tests/core/graph/graph_drive.hpp"

namespace odoless {
namespace {

constexpr Pose2 kSlight_drift{0.002, 0.0, 0.0002};

/// A world without what is needless.
struct Thin {
  explicit Thin(const SubmapWorld& of) : Thin(of, needless_submaps(of)) {}
  Thin(const SubmapWorld& of, std::vector<int> without)
      : needless(std::move(without)), store(of.store), graph(of.graph), submaps(of.submaps.begin(), of.submaps.end()) {
    static_cast<void>(leave_out(needless, store, graph, submaps));
  }
  [[nodiscard]] SubmapWorld world() const { return {store, graph, submaps, std::nullopt, graph.largest_component()}; }

  std::vector<int> needless;
  KeyframeStore store;
  PoseGraph graph;
  std::vector<Submap> submaps;
};

struct Rounds : Drive {
  explicit Rounds(int rounds, SimulatedScene scene = ring(18.0, 10.0)) : Drive(std::move(scene), kSlight_drift) {
    for (int i = 0; i < rounds; ++i) {
      drive(kRound);
    }
    graph.finish();
  }
  [[nodiscard]] int submaps() const { return static_cast<int>(graph.submaps().size()); }
};

/// What a map has at a point: percent, or OccupancyMap::kUnknown.
int at(const OccupancyMap& map, const Point2& point) {
  const int column = static_cast<int>(std::floor((point.x_m - map.origin_x_m) / map.resolution_m));
  const int row = static_cast<int>(std::floor((point.y_m - map.origin_y_m) / map.resolution_m));
  const bool is_inside = column >= 0 && row >= 0 && column < map.width_cells && row < map.height_cells;
  return is_inside ? map.at(column, row) : OccupancyMap::kUnknown;
}

/// Of the cells that one map knows, the share that the other one does not know, or has a wall in where it has none.
struct Difference {
  Difference(const OccupancyMap& map, const OccupancyMap& other) {
    int known = 0;
    for (int row = 0; row < map.height_cells; ++row) {
      for (int column = 0; column < map.width_cells; ++column) {
        const int here = map.at(column, row);
        const int there = at(other, {map.origin_x_m + (column + 0.5) * map.resolution_m,
                                     map.origin_y_m + (row + 0.5) * map.resolution_m});
        known += here == OccupancyMap::kUnknown ? 0 : 1;
        lost += here != OccupancyMap::kUnknown && there == OccupancyMap::kUnknown ? 1 : 0;
        contradicted += here != OccupancyMap::kUnknown && here < 30 && there > 70 ? 1 : 0;
      }
    }
    lost /= std::max(1, known);
    contradicted /= std::max(1, known);
  }
  double lost = 0.0;
  double contradicted = 0.0;
};

TEST(WorldThinning, LeavesAloneWhatWasSeenOnce) {
  const Rounds once(1);
  EXPECT_LE(needless_submaps(once.graph.world()).size(), 1U) << "but where the round ends in its beginning";
}

TEST(WorldThinning, KeepsTheNewestVisitOfEachPlace) {
  const Rounds once(1);
  const Rounds thrice(3);
  const Thin thin(thrice.graph.world());
  EXPECT_LE(thin.graph.size(), once.submaps() + 4) << "of " << thrice.submaps();
  ASSERT_EQ(thin.graph.size() + static_cast<int>(thin.needless.size()), thrice.submaps());
  EXPECT_EQ(thin.submaps.back().origin_stamp_ns, thrice.graph.submaps().back().origin_stamp_ns);
}

TEST(WorldThinning, MovesNothingAndLeavesOnePart) {
  const Rounds thrice(3);
  const Thin thin(thrice.graph.world());
  std::size_t at = 0;
  for (int i = 0; i < thin.graph.size(); ++i) {
    const Submap& submap = thin.submaps[static_cast<std::size_t>(i)];
    while (thrice.graph.submaps()[at].origin_stamp_ns != submap.origin_stamp_ns) {
      ++at;
    }
    EXPECT_EQ(thin.graph.pose(i).distance_m(thrice.graph.graph().pose(static_cast<int>(at))), 0.0);
    EXPECT_EQ(thin.graph.component(i), 0);
    ASSERT_EQ(submap.keyframes, thrice.graph.submaps()[at].keyframes);
    for (int k = 0; k < submap.keyframes; ++k) {
      const int before = thrice.graph.submaps()[at].first_keyframe + k;
      const int now = submap.first_keyframe + k;
      EXPECT_EQ(thin.store[now].stamp_ns, thrice.graph.keyframes()[before].stamp_ns);
      EXPECT_TRUE(std::ranges::equal(thin.store.codes(now), thrice.graph.keyframes().codes(before)));
    }
  }
  PoseGraph solved = thin.graph;
  static_cast<void>(GraphSolver().solve(solved, 25));
  for (int i = 0; i < solved.size(); ++i) {
    EXPECT_LT(solved.pose(i).distance_m(thin.graph.pose(i)), 0.05) << "what is left says the same, submap " << i;
  }
}

// From one kept keyframe to the next, over what was left out.
void expect_whole_way(const KeyframeStore& store) {
  for (int k = 1; k < store.size(); ++k) {
    const Pose2 way = store[k - 1].odom_T_scan.inverse() * store[k].odom_T_scan;
    EXPECT_LT(way.distance_m(store[k].since_last.start_T_end), 1e-6) << k;
  }
}

TEST(WorldThinning, LosesNothingOfTheWayBetween) {
  const Rounds thrice(3);
  expect_whole_way(Thin(thrice.graph.world()).store);
}

// Of the second round first every other submap goes, then the rest: the gaps meet.
TEST(WorldThinning, LosesNothingOfTheWayWhereItIsThinnedAgain) {
  const Rounds once(1);
  const Rounds thrice(3);
  std::vector<int> first;
  std::vector<int> second;
  for (const int each : needless_submaps(thrice.graph.world())) {
    if (each > once.submaps() && each % 2 == 1) {
      first.push_back(each);
    } else if (each > once.submaps()) {
      second.push_back(each - static_cast<int>(first.size()));
    }
  }
  ASSERT_GT(std::min(first.size(), second.size()), 3U);
  const Thin thin(thrice.graph.world(), first);
  expect_whole_way(thin.store);
  expect_whole_way(Thin(thin.world(), second).store);
}

TEST(WorldThinning, LeavesLittleToBeDoneAgain) {
  const Rounds thrice(3);
  const Thin thin(thrice.graph.world());
  EXPECT_LE(needless_submaps(thin.world()).size(), 2U) << "those that only what was handed over ties to newer ones";
}

TEST(WorldThinning, LeavesTheMapAsItIs) {
  const Rounds thrice(3);
  const Thin thin(thrice.graph.world());
  const OccupancyMap before = render_world(thrice.graph.world(), {}, {}, 0.1);
  const OccupancyMap after = render_world(thin.world(), {}, {}, 0.1);
  const Difference difference(before, after);
  EXPECT_LT(difference.lost, 0.02);
  EXPECT_LT(difference.contradicted, 0.002);
}

TEST(WorldThinning, TakesTheNewestVisitsWordWhereTheRoomHasChanged) {
  Rounds before(2);
  SimulatedScene with_box = ring(18.0, 10.0);
  with_box.add_box({0.0, -7.3, 0.3}, 1.0, 0.6);
  Drive later(with_box, kSlight_drift);
  ASSERT_TRUE(later.graph.resume(before.graph.world()));
  for (int i = 0; i < 2; ++i) {
    later.drive(kRound);
  }
  later.graph.finish();
  ASSERT_TRUE(later.graph.is_joined());
  const auto at_box = [](const SubmapWorld& world) {
    const OccupancyMap map = render_world(world, {}, {}, 0.1);
    int most = 0;
    for (double x_m = 9.8; x_m < 11.2; x_m += 0.05) {  // the map begins at (-10.5, -6.5), towards x
      most = std::max(most, at(map, {x_m, -0.5}));
    }
    return most;
  };
  const Thin thin(later.graph.world());
  EXPECT_LT(at_box(before.graph.world()), 30);
  EXPECT_GT(at_box(thin.world()), 70) << "as the last two rounds saw it";
}

TEST(WorldThinning, LeavesApartWhatNothingTiesTogether) {
  Rounds before(2);
  Drive elsewhere(hotel(), kSlight_drift);
  ASSERT_TRUE(elsewhere.graph.resume(before.graph.world()));
  elsewhere.drive({{1.8, 0.0}, {50.0, 0.0}});
  elsewhere.graph.finish();
  ASSERT_FALSE(elsewhere.graph.is_joined());
  const SubmapWorld world = elsewhere.graph.world();
  const Thin thin(world);
  const int first = static_cast<int>(elsewhere.graph.first_submap());
  EXPECT_TRUE(std::ranges::all_of(thin.needless, [&](int each) { return each < first; }));
  EXPECT_EQ(needless_submaps(before.graph.world()), thin.needless) << "what lies on top of it does not count";
}

TEST(WorldThinning, ARobotIsFoundInWhatIsLeft) {
  const Rounds thrice(3);
  const Thin thin(thrice.graph.world());
  const std::vector<std::vector<Point2>> drives{
      {{-10.5, 2.0}, {-10.5, -6.5}, {10.5, -6.5}, {10.5, 2.0}},
      {{10.5, -3.0}, {10.5, 6.5}, {-10.5, 6.5}},
      {{3.0, -6.5}, {-10.5, -6.5}, {-10.5, 6.5}},
  };
  for (const std::vector<Point2>& corners : drives) {
    Drive run(ring(18.0, 10.0), kSlight_drift);
    ASSERT_TRUE(run.graph.resume(thin.world()));
    run.drive(corners);
    EXPECT_TRUE(run.graph.is_joined()) << corners.front().x_m;
    EXPECT_LT((run.graph.map_T_odom() * run.odom.back().map_T_scan)
                  .distance_m(thrice.poses.front().inverse() * run.poses.back()),
              0.2);
  }
}

// Day after day: as much as the place needs.
TEST(WorldThinning, KeepsAWorldBoundedThatIsGoneOnWith) {
  std::vector<int> sizes;
  std::optional<Thin> world;
  for (int day = 0; day < 5; ++day) {
    Drive run(ring(18.0, 10.0), kSlight_drift);
    ASSERT_TRUE(!world || run.graph.resume(world->world()));
    run.drive(kRound);
    run.drive(kRound);
    run.graph.finish();
    ASSERT_TRUE(run.graph.is_joined()) << day;
    world.emplace(run.graph.world());
    sizes.push_back(world->graph.size());
    EXPECT_LT(static_cast<double>(world->graph.constraints().size()), 25.0 * world->graph.size());
  }
  EXPECT_LE(sizes.back(), sizes.front() + 4);
}

}  // namespace
}  // namespace odoless
