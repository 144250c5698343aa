#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "core/geometry/pose2.hpp"

namespace odoless {

/// The cells that a straight beam crosses, in order, with the length of its path in each [amanatides1987traversal].
///
/// Distances along the beam are kept as integers (2^-32 of a cell), which makes a step a handful of short instructions
/// and the walk free of rounding drift: BM_GridWalk.
///
/// Units:     cells; cell (c, r) covers [c, c+1) x [r, r+1).
/// Promises:  lengths are >= 0 and sum up to the beam's; neighbours differ by one in one coordinate; at most
///            2 * length_cells + 3 cells.
/// Real time: no allocation, bounded by the length.
class GridWalk {
 public:
  /// @param start         Where the beam begins; beyond +-10^9 it is moved there, far outside of any grid.
  /// @param direction     Unit vector.
  /// @param length_cells  >= 0; more than 10^6 cells are cut to that.
  GridWalk(const Point2& start, const Point2& direction, double length_cells)
      : column_(cell_of(start.x_m)),
        row_(cell_of(start.y_m)),
        step_x_(direction.x_m < 0.0 ? -1 : 1),
        step_y_(direction.y_m < 0.0 ? -1 : 1),
        delta_x_(ticks(1.0 / std::abs(direction.x_m))),
        delta_y_(ticks(1.0 / std::abs(direction.y_m))),
        next_x_(ticks(way_to_border(start.x_m, column_, step_x_) / std::abs(direction.x_m))),
        next_y_(ticks(way_to_border(start.y_m, row_, step_y_) / std::abs(direction.y_m))),
        end_(ticks(std::min(length_cells, kLengthMaxCells))),
        exit_(std::min({next_x_, next_y_, end_})) {}

  [[nodiscard]] int column() const { return column_; }
  [[nodiscard]] int row() const { return row_; }
  /// Way from the start to where the beam enters and leaves the present cell.
  [[nodiscard]] float enter() const { return cells(enter_); }
  [[nodiscard]] float exit() const { return cells(exit_); }
  /// Length of the path in the present cell.
  [[nodiscard]] float length_cells() const { return cells(exit_ - enter_); }
  [[nodiscard]] bool is_last() const { return exit_ == end_; }

  /// Steps into the next cell; false, and stays, at the end of the beam.
  bool next() {
    if (is_last()) {
      return false;
    }
    const bool crosses_x = next_x_ < next_y_;  // selects, not branches: the order of crossings is unpredictable
    column_ += crosses_x ? step_x_ : 0;
    row_ += crosses_x ? 0 : step_y_;
    next_x_ += crosses_x ? delta_x_ : 0;
    next_y_ += crosses_x ? 0 : delta_y_;
    enter_ = exit_;
    exit_ = std::min({next_x_, next_y_, end_});
    return true;
  }

 private:
  static constexpr double kTicksPerCell = 0x1p32;
  static constexpr double kTicksMax = 0x1p61;  // two of them can be added
  static constexpr double kLengthMaxCells = 1e6;
  static constexpr double kStartMax = 1e9;

  static int cell_of(double x) { return static_cast<int>(std::floor(std::clamp(x, -kStartMax, kStartMax))); }
  static double way_to_border(double x, int cell, int step) {
    return std::clamp(step > 0 ? cell + 1 - x : x - cell, 0.0, 1.0);
  }
  static std::int64_t ticks(double length_cells) {
    // A beam along an axis never reaches the other one's border: infinite, or 0/0 on it.
    const double scaled = length_cells * kTicksPerCell;
    return static_cast<std::int64_t>(scaled < kTicksMax ? scaled : kTicksMax);
  }
  static float cells(std::int64_t ticks) { return static_cast<float>(ticks) * static_cast<float>(1.0 / kTicksPerCell); }

  int column_;
  int row_;
  int step_x_;
  int step_y_;
  std::int64_t delta_x_;
  std::int64_t delta_y_;
  std::int64_t next_x_;
  std::int64_t next_y_;
  std::int64_t end_;
  std::int64_t enter_ = 0;
  std::int64_t exit_;
};

}  // namespace odoless
