#include "core/slam/earlier_map.hpp"

#include <gtest/gtest.h>

namespace odoless {
namespace {

constexpr AncestryGridParams kGrid{.resolution_m = 0.1, .width_m = 20.0, .height_m = 20.0, .tiles_max = 4000};

/// A grid as a search reads it.
class GridSquares final : public MapSquares {
 public:
  explicit GridSquares(AncestryGrid& grid) : grid_(grid) {}
  [[nodiscard]] GridGeometry geometry() const override { return grid_.geometry(); }
  [[nodiscard]] bool read(GridCell corner, Square& percent) override {
    return grid_.write_square(0, 0.02, corner, kSide_cells, percent);
  }

 private:
  AncestryGrid& grid_;
};

void wall(AncestryGrid& grid, int column) {
  AncestryGrid::Writer writer = grid.writer(0);
  for (int row = 90; row < 110; ++row) {
    for (int free = column - 10; free < column; ++free) {
      writer.at({free, row}).pass(Cell::kParts);
    }
    Cell& cell = writer.at({column, row});
    cell.pass(Cell::kParts / 2);
    cell.hit();
  }
}

TEST(EarlierMap, LacksWhatWasMappedSince) {
  AncestryGrid grid(kGrid, 1);
  wall(grid, 100);
  GlobalSearch search({}, grid.geometry(), 100);
  GridSquares squares(grid);
  while (!search.has_map()) {
    static_cast<void>(search.work(squares, 1000));
  }
  wall(grid, 97);   // into what was free
  wall(grid, 120);  // into what was unknown
  EarlierMap earlier(grid.view(0), grid.geometry(), search);
  EXPECT_GT(earlier.at({100, 100}).hits(), 0U);
  EXPECT_TRUE(earlier.at({97, 100}).is_free());
  EXPECT_TRUE(earlier.at({92, 100}).is_free());
  EXPECT_TRUE(earlier.at({115, 100}).is_unknown());
  EXPECT_TRUE(earlier.at({120, 100}).is_unknown());
}

}  // namespace
}  // namespace odoless
