#include "core/grid/ancestry_grid.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdlib>
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
  /// @param first  Of the columns and rows.
  explicit CopiedMaps(int side_cells, int first = 0) : side_(side_cells), first_(first), maps_(1) {
    maps_[0].resize(cells());
  }

  Cell& at(std::size_t particle, int column, int row) {
    return maps_[particle][static_cast<std::size_t>((row - first_) * side_ + column - first_)];
  }
  /// Forgets all cells for which this is true.
  template <class Is>
  void forget(const Is& is) {
    for (std::size_t particle = 0; particle < maps_.size(); ++particle) {
      for (int row = first_; row < first_ + side_; ++row) {
        for (int column = first_; column < first_ + side_; ++column) {
          if (is(column, row)) {
            at(particle, column, row) = Cell{};
          }
        }
      }
    }
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
  int first_;
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
    const int column = grid.geometry().first_column + static_cast<int>(rng.below(kSide_cells - 8));
    const int row = grid.geometry().first_row + static_cast<int>(rng.below(kSide_cells - 8));
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

void expect_equal_maps(AncestryGrid& grid, CopiedMaps& maps, int particles, int first = 0, int side = kSide_cells) {
  for (int particle = 0; particle < particles; ++particle) {
    AncestryGrid::View view = grid.view(particle);
    for (int row = first; row < first + side; ++row) {
      for (int column = first; column < first + side; ++column) {
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

TEST(AncestryGrid, IsAWindowThatForgetsWhatItLeavesBehindAndWhatGrowsOld) {
  constexpr int kTile_cells = AncestryGrid::kTileSide_cells;
  constexpr int kFirst = -208;  // a plane around all that the window comes to
  constexpr int kPlane_cells = 496;
  constexpr int kParticles = 6;
  AncestryGrid grid(small_grid(), kParticles);
  CopiedMaps maps(kPlane_cells, kFirst);
  Rng rng(11);
  int column = kSide_cells / 2;
  int row = kSide_cells / 2;
  std::array<double, (kPlane_cells / kTile_cells) * (kPlane_cells / kTile_cells)> written{};
  const auto tile_of = [](int x, int y) {
    return static_cast<std::size_t>((y - kFirst) / kTile_cells * (kPlane_cells / kTile_cells) +
                                    (x - kFirst) / kTile_cells);
  };
  std::int64_t moves = 0;
  std::int64_t forgotten = 0;
  for (int round = 0; round < 120; ++round) {
    const GridGeometry before = grid.geometry();
    column = std::clamp(column + static_cast<int>(rng.below(21)) - 8, kFirst + 64, kFirst + kPlane_cells - 64);
    row = std::clamp(row + static_cast<int>(rng.below(21)) - 12, kFirst + 64, kFirst + kPlane_cells - 64);
    const std::vector<int> copies = random_copies(grid.tree().particles(), kParticles, rng);
    grid.retain(copies);
    grid.branch(copies);
    maps.resample(copies);
    grid.set_travel(round);
    static_cast<void>(grid.view(0).at({column, row}));  // answers that are there already are forgotten, too
    grid.follow({column, row});
    const GridGeometry& now = grid.geometry();
    moves += now.first_column != before.first_column || now.first_row != before.first_row ? 1 : 0;
    ASSERT_LE(std::abs(now.first_column - before.first_column), kTile_cells);
    ASSERT_GE(column, now.first_column + kTile_cells / 4);
    ASSERT_LT(column, now.first_column + kSide_cells - kTile_cells / 4);
    grid.forget_before(round - 2.0, 25);  // all of them
    maps.forget([&](int x, int y) {
      const bool is_outside = x < now.first_column || y < now.first_row || x >= now.first_column + kSide_cells ||
                              y >= now.first_row + kSide_cells;
      const bool is_old = written[tile_of(x, y)] < round - 2.0;
      forgotten += is_old && !is_outside && !maps.at(0, x, y).is_unknown() ? 1 : 0;
      return is_outside || is_old;
    });
    for (int i = 0; i < kParticles; i += 2) {
      CopiedMaps noted = maps;
      observe(grid, maps, i, rng);
      for (int y = now.first_row; y < now.first_row + kSide_cells; ++y) {
        for (int x = now.first_column; x < now.first_column + kSide_cells; ++x) {
          if (!(noted.at(static_cast<std::size_t>(i), x, y) == maps.at(static_cast<std::size_t>(i), x, y))) {
            written[tile_of(x, y)] = round;
          }
        }
      }
    }
    ASSERT_NO_FATAL_FAILURE(expect_equal_maps(grid, maps, kParticles, kFirst, kPlane_cells)) << "round " << round;
  }
  EXPECT_GT(moves, 20);
  EXPECT_GT(forgotten, 500);
  EXPECT_EQ(grid.counters().refused_tiles, 0);
  EXPECT_EQ(grid.counters().outside_tiles, 0);
}

TEST(AncestryGrid, HasNoEdge) {
  AncestryGrid grid(small_grid(), 1);
  grid.centre_on({1'000'000'000, -1'000'000'000});
  grid.writer(0).at({1'000'000'000, -1'000'000'000}).hit();
  EXPECT_EQ(grid.view(0).at({1'000'000'000, -1'000'000'000}).hits(), 1U);
  OccupancyMap map;
  grid.write_occupancy(0, 0.01, map);
  EXPECT_EQ(map.width_cells, AncestryGrid::kTileSide_cells);
  EXPECT_NEAR(map.origin_x_m, 1e8, 8.0);
  EXPECT_EQ(grid.counters().outside_tiles, 0);
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
