#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/check.hpp"

namespace odoless {

/// A cell of which nothing is known; others are occupancy in percent.
inline constexpr std::uint8_t kUnknownCell = 255;

/// A whole map, or a coarser picture of it; a view.
struct MapView {
  std::int64_t stamp_ns = 0;
  double lower_left_x_m = 0.0;  ///< corner of the first cell, map frame
  double lower_left_y_m = 0.0;
  double cell_size_m = 0.0;
  int columns = 0;
  int rows = 0;
  std::span<const std::uint8_t> cells{};  ///< columns * rows, row by row from the lowest y
};

/// Cells that a map of half the resolution has.
[[nodiscard]] constexpr std::size_t halved_cells(int columns, int rows) {
  return static_cast<std::size_t>((columns + 1) / 2) * static_cast<std::size_t>((rows + 1) / 2);
}

namespace detail {

/// The most occupied of those that are known: a wall stays, however thin.
constexpr std::uint8_t merged(std::uint8_t a, std::uint8_t b) {
  if (a == kUnknownCell || b == kUnknownCell) {
    return std::min(a, b);
  }
  return std::max(a, b);
}

}  // namespace detail

/// The map at half its resolution: each cell is the most occupied of the four below. `out` has room for
/// `halved_cells`, and may be where `map.cells` already is: a cell is written behind all that are still to be read.
[[nodiscard]] inline MapView halved(const MapView& map, std::span<std::uint8_t> out) {
  MapView half = map;
  half.columns = (map.columns + 1) / 2;
  half.rows = (map.rows + 1) / 2;
  half.cell_size_m = 2.0 * map.cell_size_m;
  ODOLESS_CHECK(out.size() >= halved_cells(map.columns, map.rows));
  const auto at = [&map](int column, int row) {
    return column < map.columns && row < map.rows
               ? map.cells[static_cast<std::size_t>(row) * static_cast<std::size_t>(map.columns) +
                           static_cast<std::size_t>(column)]
               : kUnknownCell;
  };
  std::size_t next = 0;
  for (int row = 0; row < map.rows; row += 2) {
    for (int column = 0; column < map.columns; column += 2) {
      const std::uint8_t lower = detail::merged(at(column, row), at(column + 1, row));
      out[next++] = detail::merged(lower, detail::merged(at(column, row + 1), at(column + 1, row + 1)));
    }
  }
  half.cells = out.first(next);
  return half;
}

}  // namespace odoless
