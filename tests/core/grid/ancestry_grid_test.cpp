#include "core/grid/ancestry_grid.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "core/base/rng.hpp"

namespace odoless {
namespace {

constexpr int kSide_cells = 80;  // five tiles

AncestryGridParams small_grid(int tiles_max = 4000) {
  return {.resolution_m = 0.1, .width_m = 0.1 * kSide_cells, .height_m = 0.1 * kSide_cells, .tiles_max = tiles_max};
}

/// Every particle with a map of its own, copied at each resampling.
class CopiedMaps {
 public:
  explicit CopiedMaps(int side_cells) : side_(side_cells), maps_(1) { maps_[0].resize(cells()); }

  Cell& at(std::size_t particle, int column, int row) {
    return maps_[particle][static_cast<std::size_t>(row * side_ + column)];
  }
  void resample(const std::vector<int>& copies) {
    std::vector<std::vector<Cell>> next;
    for (std::size_t i = 0; i < copies.size(); ++i) {
      next.insert(next.end(), static_cast<std::size_t>(copies[i]), maps_[i]);
    }
    maps_ = std::move(next);
  }

 private:
  [[nodiscard]] std::size_t cells() const { return static_cast<std::size_t>(side_) * static_cast<std::size_t>(side_); }

  int side_;
  std::vector<std::vector<Cell>> maps_;
};

std::vector<int> random_copies(int particles, int wanted, Rng& rng) {
  std::vector<int> copies(static_cast<std::size_t>(particles), 0);
  for (int i = 0; i < wanted; ++i) {
    const auto bound = static_cast<std::uint32_t>(particles);
    ++copies[std::min(rng.below(bound), rng.below(bound))];
  }
  return copies;
}

/// One particle writes a few blobs of observations, to both.
void observe(AncestryGrid& grid, CopiedMaps& maps, int particle, Rng& rng) {
  AncestryGrid::Writer writer = grid.writer(particle);
  for (int blob = 0; blob < 3; ++blob) {
    const auto column = static_cast<int>(rng.below(kSide_cells - 8));
    const auto row = static_cast<int>(rng.below(kSide_cells - 8));
    for (int i = 0; i < 12; ++i) {
      const int x = column + static_cast<int>(rng.below(8));
      const int y = row + static_cast<int>(rng.below(8));
      const std::uint32_t way_parts = rng.below(46);
      const bool hit = rng.below(3) == 0;
      for (Cell* cell : {&writer.at({x, y}), &maps.at(static_cast<std::size_t>(particle), x, y)}) {
        cell->pass(way_parts);
        if (hit) {
          cell->hit();
        }
      }
    }
  }
}

void expect_equal_maps(AncestryGrid& grid, CopiedMaps& maps, int particles) {
  for (int particle = 0; particle < particles; ++particle) {
    AncestryGrid::View view = grid.view(particle);
    for (int row = 0; row < kSide_cells; ++row) {
      for (int column = 0; column < kSide_cells; ++column) {
        const Cell& expected = maps.at(static_cast<std::size_t>(particle), column, row);
        ASSERT_EQ(view.at({column, row}), expected) << particle << " at " << column << ", " << row;
      }
    }
  }
}

TEST(AncestryGrid, ShowsEveryParticleTheMapThatACopyOfItsOwnWouldHave) {
  for (const int particles : {1, 2, 9, 24}) {
    AncestryGrid grid(small_grid(), particles);
    CopiedMaps maps(kSide_cells);
    Rng rng(static_cast<std::uint64_t>(particles));
    for (int round = 0; round < 40; ++round) {
      const std::vector<int> copies = random_copies(grid.tree().particles(), particles, rng);
      grid.retain(copies);
      for (std::size_t i = 0; i < copies.size(); ++i) {
        if (copies[i] > 0) {
          observe(grid, maps, static_cast<int>(i), rng);
        }
      }
      grid.branch(copies);
      maps.resample(copies);
      for (int i = 0; i < particles; i += 2) {  // leaves that write without a resampling
        observe(grid, maps, i, rng);
      }
      ASSERT_NO_FATAL_FAILURE(expect_equal_maps(grid, maps, particles)) << particles << " round " << round;
    }
    EXPECT_EQ(grid.counters().refused_tiles, 0);
  }
}

TEST(AncestryGrid, KeepsOneVersionPerTileOnceAllDescendFromOneParticle) {
  AncestryGrid grid(small_grid(), 8);
  CopiedMaps maps(kSide_cells);
  Rng rng(3);
  grid.branch(std::vector<int>{8});
  maps.resample({8});
  observe(grid, maps, 0, rng);
  const int tiles_of_one = grid.tiles_used();
  for (int i = 1; i < 8; ++i) {
    observe(grid, maps, i, rng);
  }
  EXPECT_GT(grid.tiles_used(), tiles_of_one);
  const std::vector<int> copies{8, 0, 0, 0, 0, 0, 0, 0};
  grid.retain(copies);
  grid.branch(copies);
  EXPECT_EQ(grid.tiles_used(), tiles_of_one);
  grid.reset();
  EXPECT_EQ(grid.tiles_used(), 0);
}

TEST(AncestryGrid, IsUnknownOutsideAndCountsWhatIsWrittenThere) {
  AncestryGrid grid(small_grid(), 1);
  for (const auto& [column, row] : {std::pair{-1, 3}, {3, -1}, {1 << 30, 0}, {0, 1 << 30}, {-(1 << 30), 5}}) {
    EXPECT_TRUE(grid.view(0).at({column, row}).is_unknown());
    grid.writer(0).at({column, row}).hit();
    EXPECT_TRUE(grid.view(0).at({column, row}).is_unknown());
  }
  EXPECT_EQ(grid.counters().outside_tiles, 5);
  EXPECT_EQ(grid.tiles_used(), 0);
}

TEST(AncestryGrid, RefusesAndCountsWhenThePoolIsFullAndLeavesOtherMapsAlone) {
  AncestryGrid grid(small_grid(16), 2);
  for (int i = 0; i < 16; ++i) {
    grid.writer(0).at({16 * (i % 4), 16 * (i / 4)}).hit();
  }
  EXPECT_EQ(grid.counters().refused_tiles, 0);
  grid.branch(std::vector<int>{2});
  grid.writer(1).at({0, 0}).hit();
  EXPECT_EQ(grid.counters().refused_tiles, 1);
  EXPECT_EQ(grid.view(0).at({0, 0}).hits(), 1U);
  EXPECT_EQ(grid.view(1).at({0, 0}).hits(), 1U);
  grid.retain(std::vector<int>{0, 1});
  grid.branch(std::vector<int>{0, 1});
  grid.writer(0).at({0, 0}).hit();
  EXPECT_EQ(grid.view(0).at({0, 0}).hits(), 2U);
}

TEST(AncestryGrid, WritesOccupancyOfTheKnownTilesWithTheirPlaceInTheMap) {
  AncestryGrid grid(small_grid(), 2);
  grid.writer(0).at({20, 40}) = Cell(64, 2);  // rho is a cell's width
  grid.writer(0).at({21, 40}) = Cell(1600, 0);
  grid.branch(std::vector<int>{2});
  grid.writer(1).at({60, 60}) = Cell(1600, 0);
  OccupancyMap map;
  grid.write_occupancy(0, 0.01, map);
  EXPECT_EQ(map.width_cells, 16);
  EXPECT_EQ(map.height_cells, 16);
  EXPECT_NEAR(map.origin_x_m, -4.0 + 1.6, 1e-12);
  EXPECT_NEAR(map.origin_y_m, -4.0 + 3.2, 1e-12);
  EXPECT_EQ(map.at(4, 8), 63);  // 1 - 1/e
  EXPECT_EQ(map.at(5, 8), 0);
  EXPECT_EQ(map.at(6, 8), OccupancyMap::kUnknown);
  grid.write_occupancy(1, 0.01, map);
  EXPECT_EQ(map.width_cells, 48);
}

TEST(AncestryGrid, WritesAnEmptyMapBeforeTheFirstObservation) {
  AncestryGrid grid(small_grid(), 1);
  OccupancyMap map;
  grid.write_occupancy(0, 0.01, map);
  EXPECT_EQ(map.width_cells, 0);
  EXPECT_TRUE(map.occupancy_percent.empty());
}

}  // namespace
}  // namespace odoless
