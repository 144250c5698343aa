#include "firmware/lcm/map_view.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "core/base/rng.hpp"

namespace odoless {
namespace {

TEST(MapView, KeepsTheMostOccupiedOfFour) {
  Rng rng(3);
  for (int i = 0; i < 200; ++i) {
    const int columns = 1 + static_cast<int>(rng.below(9));
    const int rows = 1 + static_cast<int>(rng.below(9));
    std::vector<std::uint8_t> cells(static_cast<std::size_t>(columns * rows));
    for (std::uint8_t& cell : cells) {
      cell = rng.below(2) == 0 ? kUnknownCell : static_cast<std::uint8_t>(rng.below(101));
    }
    std::vector<std::uint8_t> expected(halved_cells(columns, rows), kUnknownCell);
    for (int row = 0; row < rows; ++row) {
      for (int column = 0; column < columns; ++column) {
        const std::uint8_t cell = cells[static_cast<std::size_t>(row * columns + column)];
        std::uint8_t& merged = expected[static_cast<std::size_t>(row / 2 * ((columns + 1) / 2) + column / 2)];
        if (cell != kUnknownCell) {
          merged = merged == kUnknownCell ? cell : std::max(merged, cell);
        }
      }
    }
    const MapView half = halved({.columns = columns, .rows = rows, .cells = cells}, cells);  // in place
    EXPECT_EQ(std::vector<std::uint8_t>(half.cells.begin(), half.cells.end()), expected);
  }
}

}  // namespace
}  // namespace odoless
