#pragma once

#include "core/geometry/pose2.hpp"

namespace odoless {

/// Where a grid lies in the map frame. The map's origin is the grid's centre.
struct GridGeometry {
  double resolution_m = 0.05;
  int columns = 0;
  int rows = 0;

  [[nodiscard]] double origin_x_m() const { return -0.5 * columns * resolution_m; }
  [[nodiscard]] double origin_y_m() const { return -0.5 * rows * resolution_m; }

  /// Map coordinates in cells from the lower-left corner.
  [[nodiscard]] Point2 cells(double x_m, double y_m) const {
    return {(x_m - origin_x_m()) / resolution_m, (y_m - origin_y_m()) / resolution_m};
  }
};

}  // namespace odoless
