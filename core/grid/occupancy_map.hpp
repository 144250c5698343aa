#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace odoless {

/// A finished map, for saving and showing. Row 0 is the lowest y, column 0 the lowest x.
struct OccupancyMap {
  static constexpr std::int8_t kUnknown = -1;

  double resolution_m = 0.05;
  double origin_x_m = 0.0;  ///< lower-left corner of the lower-left cell, map frame
  double origin_y_m = 0.0;
  int width_cells = 0;
  int height_cells = 0;
  std::vector<std::int8_t> occupancy_percent;  ///< kUnknown or 0..100, row by row

  [[nodiscard]] std::int8_t at(int column, int row) const {
    return occupancy_percent[static_cast<std::size_t>(row) * static_cast<std::size_t>(width_cells) +
                             static_cast<std::size_t>(column)];
  }
};

}  // namespace odoless
