#pragma once

#include "core/geometry/pose2.hpp"

namespace odoless {

/// Where a grid lies in the map frame. It begins with its centre at the map's origin, where cells are counted from its
/// lower-left corner; a grid that has moved since begins at another cell.
struct GridGeometry {
  double resolution_m = 0.05;
  int columns = 0;
  int rows = 0;
  int first_column = 0;
  int first_row = 0;

  /// Of cell (0, 0), wherever the grid has moved.
  [[nodiscard]] double origin_x_m() const { return -0.5 * columns * resolution_m; }
  [[nodiscard]] double origin_y_m() const { return -0.5 * rows * resolution_m; }
  [[nodiscard]] Point2 centre_m() const { return {first_column * resolution_m, first_row * resolution_m}; }

  /// Map coordinates in cells from the lower-left corner of cell (0, 0).
  [[nodiscard]] Point2 cells(double x_m, double y_m) const {
    return {(x_m - origin_x_m()) / resolution_m, (y_m - origin_y_m()) / resolution_m};
  }
};

}  // namespace odoless
