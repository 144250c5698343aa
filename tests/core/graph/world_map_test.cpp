// The map of a world: what all beams say of each cell, however it is drawn.
#include "core/graph/world_map.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "core/graph/world_tiles.hpp"
#include "core/slam/scan_beams.hpp"
#include "tests/core/graph/graph_drive.hpp"

namespace odoless {
namespace {

TEST(WorldMap, HasTheWallsOfTheWorldAtTheirPlaces) {
  Drive run(ring(18.0, 10.0), {0.01, 0.0, 0.0006});
  run.drive(kRound);
  run.drive({kRound[0], kRound[1]});
  run.graph.finish();
  const OccupancyMap map = render_world(run.graph.world(), {}, {}, 0.05);
  const SimulatedScene scene = ring(18.0, 10.0);
  int occupied = 0;
  int right = 0;
  for (int row = 0; row < map.height_cells; ++row) {
    for (int column = 0; column < map.width_cells; ++column) {
      if (map.at(column, row) < 65) {
        continue;
      }
      const Point2 p_map{map.origin_x_m + (column + 0.5) * map.resolution_m,
                         map.origin_y_m + (row + 0.5) * map.resolution_m};
      ++occupied;
      right += scene.clearance_m(run.poses.front() * p_map) < 0.3 ? 1 : 0;
    }
  }
  EXPECT_GT(occupied, 1500);
  EXPECT_GT(right, 0.97 * occupied);
}

/// Every beam whole, into cells kept one by one.
struct PlainCells {
  std::map<std::pair<int, int>, Cell> cells;
  [[nodiscard]] Cell& at(const GridCell& cell) { return cells[{cell.column(), cell.row()}]; }
};

TEST(WorldMap, HasWhatAllBeamsSayOfEachCell) {
  Drive run(ring(40.0, 20.0), {0.01, 0.0, 0.0006});
  run.drive(kRound);
  run.graph.finish();
  const SubmapWorld world = run.graph.world();
  PlainCells plain;
  ScanFrame frame(ScanParams{});
  for (std::size_t i = 0; i < world.submaps.size(); ++i) {
    for (int k = 0; k < world.submaps[i].keyframes; ++k) {
      const int keyframe = world.submaps[i].first_keyframe + k;
      world.store.load(keyframe, 1, frame);
      const Pose2 map_T_scan = world.graph.pose(static_cast<int>(i)) * world.store.submap_T_scan(keyframe);
      integrate_scan(BeamModel({}, 0.05), BeamCaster(GridGeometry{}, map_T_scan), plain, frame, 0.0);
    }
  }
  const OccupancyMap map = render_world(world, {}, {}, 0.05);
  const int first_column = static_cast<int>(std::lround(map.origin_x_m / 0.05));
  const int first_row = static_cast<int>(std::lround(map.origin_y_m / 0.05));
  std::size_t known = 0;
  std::size_t off = 0;
  for (int row = 0; row < map.height_cells; ++row) {
    for (int column = 0; column < map.width_cells; ++column) {
      const auto found = plain.cells.find({first_column + column, first_row + row});
      const bool is_known = found != plain.cells.end() && !found->second.is_unknown();
      const int expected = is_known ? found->second.occupancy_percent(0.02F / 0.05F * Cell::kParts) : -1;
      known += is_known ? 1 : 0;
      off += std::abs(expected - map.at(column, row)) > 3 ? 1 : 0;
    }
  }
  EXPECT_GT(map.width_cells, 600) << "more than one piece";
  EXPECT_GT(known, 50'000U);
  EXPECT_LT(off, known / 1000);  // where a beam grazes a corner of a cell, ways are rounded otherwise
  EXPECT_GT(known + 10,
            static_cast<std::size_t>(std::count_if(plain.cells.begin(), plain.cells.end(),
                                                   [](const auto& cell) { return !cell.second.is_unknown(); })));
}

// 40 km by 40 km with cells of 5 cm would be 6 * 10^11 of them.
TEST(WorldMap, OfAVastWorldHasLargerCells) {
  GraphParams params;
  SubmapGraph graph(params, {}, {}, 1);
  Feed feed(params);
  const SimulatedScene scene = ring(18.0, 10.0);
  Rng rng(1);
  for (int i = 0; i < 4; ++i) {
    Motion motion;
    if (i > 0) {
      motion = Motion::between(i, i + 1, {10000.0, 10000.0, 0.0});
      motion.odom_T_current = Pose2{10000.0 * i, 10000.0 * i, 0.0};
    }
    feed.add(sweep(scene, {.beams = 61}, {-10.5, -6.5, 0.0}, rng, i), motion, graph);
  }
  graph.finish();
  const OccupancyMap map = render_world(graph.world(), {}, {}, 0.05);
  EXPECT_GT(map.resolution_m, 1.0);
  EXPECT_FALSE(map.occupancy_percent.empty());
  EXPECT_LT(map.occupancy_percent.size(), 120'000'000U);
}

// Else the map of a building in a far corner would be mostly memory.
TEST(WorldMap, EndsWhereTheFarthestBeamsEnd) {
  Drive run(ring(18.0, 10.0), {0.01, 0.0, 0.0006});
  run.drive({kRound[0], kRound[1]});
  const OccupancyMap map = render_world(run.graph.world(), {}, {}, 0.05);
  int known[4] = {};
  for (int row = 0; row < map.height_cells; ++row) {
    for (int column = 0; column < map.width_cells; ++column) {
      const bool is_known = map.at(column, row) != OccupancyMap::kUnknown;
      known[0] += is_known && row == 0 ? 1 : 0;
      known[1] += is_known && row == map.height_cells - 1 ? 1 : 0;
      known[2] += is_known && column == 0 ? 1 : 0;
      known[3] += is_known && column == map.width_cells - 1 ? 1 : 0;
    }
  }
  EXPECT_THAT(known, testing::Each(testing::Gt(0)));
}

TEST(WorldMap, OfNothingHasNoCell) {
  const SubmapGraph graph(GraphParams{}, {}, {}, 1);
  const OccupancyMap map = render_world(graph.world(), {}, {}, 0.05);
  EXPECT_TRUE(map.occupancy_percent.empty());
}

/// All that was told of a world, as who listens has it.
class Listener {
 public:
  int follow(const SubmapGraph& graph) {
    tiles_.update(graph.world());
    while (tiles_.work(graph.world())) {
    }
    int told = 0;
    WorldTiles::Occupancy cells;
    for (auto index = tiles_.tell(cells); index; index = tiles_.tell(cells), ++told) {
      heard_[{index->column, index->row}] = cells;
    }
    return told;
  }

  [[nodiscard]] int at(int column, int row) const {
    const auto tile = [](int cell) { return static_cast<int>(std::floor(cell / double{WorldTiles::kSide_cells})); };
    const auto found = heard_.find({tile(column), tile(row)});
    const auto in_tile = [&](int cell) {
      return static_cast<std::size_t>(cell - tile(cell) * WorldTiles::kSide_cells);
    };
    return found == heard_.end() ? 255 : found->second[in_tile(row) * WorldTiles::kSide_cells + in_tile(column)];
  }

 private:
  WorldTiles tiles_{{}, {}, 0.05, GraphParams{}.keyframes_max};
  std::map<std::pair<int, int>, WorldTiles::Occupancy> heard_;
};

/// Cells that are otherwise in the map drawn at once.
int cells_off(const Listener& listener, const SubmapGraph& graph) {
  const OccupancyMap map = render_world(graph.world(), {}, {}, 0.05);
  int off = 0;
  for (int row = 0; row < map.height_cells; ++row) {
    for (int column = 0; column < map.width_cells; ++column) {
      const int heard = listener.at(column + static_cast<int>(std::lround(map.origin_x_m / 0.05)),
                                    row + static_cast<int>(std::lround(map.origin_y_m / 0.05)));
      off += std::abs(static_cast<std::uint8_t>(map.at(column, row)) - heard) > 1 ? 1 : 0;
    }
  }
  return off;
}

TEST(WorldTiles, AreTheMapThatIsDrawnAtOnce) {
  Drive run(ring(40.0, 20.0), {});
  Listener listener;
  run.drive({{-21.5, -11.5}, {10.0, -11.5}});
  EXPECT_GT(listener.follow(run.graph), 10);
  EXPECT_EQ(cells_off(listener, run.graph), 0);
  run.drive({{10.0, -11.5}, {10.5, -11.5}});  // a keyframe or two more are drawn on what is there
  EXPECT_GT(listener.follow(run.graph), 0);
  EXPECT_EQ(cells_off(listener, run.graph), 0);
  EXPECT_EQ(listener.follow(run.graph), 0) << "nothing has changed";
}

TEST(WorldTiles, AreDrawnAnewWhereACorrectionMovesThem) {
  Drive run(ring(18.0, 10.0), {0.01, 0.0, 0.0006});
  Listener listener;
  std::size_t known = 0;
  for (int round = 0; round < 2; ++round) {
    for (std::size_t i = 1; i < kRound.size(); ++i) {
      run.drive({kRound[i - 1], kRound[i]});
      listener.follow(run.graph);
    }
    known += run.graph.submaps().size();
  }
  run.graph.finish();
  ASSERT_GT(run.graph.counts().accepted, 5) << "nothing was corrected";
  listener.follow(run.graph);
  // Submaps that were moved by less than a cell are where they were.
  EXPECT_LT(cells_off(listener, run.graph), 4000);
  EXPECT_GT(known, 10U);
}

}  // namespace
}  // namespace odoless
