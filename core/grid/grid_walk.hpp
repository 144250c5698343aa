#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "core/geometry/pose2.hpp"
#include "core/grid/cell.hpp"
#include "core/grid/grid_cell.hpp"

namespace odoless {

/// The cells that a straight beam crosses, in order, with the length of its path in each [amanatides1987traversal;
/// method 6].
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
      : GridWalk(start, direction, {1.0 / std::abs(direction.x_m), 1.0 / std::abs(direction.y_m)}, length_cells) {}

  [[nodiscard]] const GridCell& cell() const { return cell_; }
  /// Way from the start to where the beam enters and leaves the present cell.
  [[nodiscard]] float enter() const { return cells(enter_); }
  [[nodiscard]] float exit() const { return cells(exit_); }
  /// Length of the path in the present cell.
  [[nodiscard]] float length_cells() const { return cells(exit_ - enter_); }
  /// The same in parts of a cell, each end rounded, so that the lengths of a walk sum up to its own.
  [[nodiscard]] std::uint32_t length_parts() const { return parts(exit_) - parts(enter_); }

  /// Steps into the next cell; false, and stays, at the end of the beam.
  bool next() {
    if (exit_ == end_) {
      return false;
    }
    const bool crosses_x = next_x_ < next_y_;
    cell_.add(crosses_x ? step_x_ : step_y_);
    next_x_ += crosses_x ? delta_x_ : 0;
    next_y_ += crosses_x ? 0 : delta_y_;
    enter_ = exit_;
    exit_ = std::min({next_x_, next_y_, end_});
    return true;
  }

 private:
  static constexpr int kTicksBits = 32;
  static constexpr double kTicksPerCell = 0x1p32;
  static constexpr std::int64_t kTicksPerPart = (std::int64_t{1} << kTicksBits) / Cell::kParts;
  static constexpr double kTicksMax = 0x1p61;  // two of them can be added
  static constexpr double kLengthMaxCells = 1e6;
  static constexpr double kStartMax = 1e9;

  /// `cells_per_border`: way along the beam from one border to the next, in x and in y.
  GridWalk(const Point2& start, const Point2& direction, const Point2& cells_per_border, double length_cells)
      : cell_(cell_of(start.x_m), cell_of(start.y_m)),
        step_x_(GridCell::step(direction.x_m < 0.0 ? -1 : 1, 0)),
        step_y_(GridCell::step(0, direction.y_m < 0.0 ? -1 : 1)),
        delta_x_(ticks(cells_per_border.x_m)),
        delta_y_(ticks(cells_per_border.y_m)),
        next_x_(ticks(to_border(start.x_m, direction.x_m) * cells_per_border.x_m)),
        next_y_(ticks(to_border(start.y_m, direction.y_m) * cells_per_border.y_m)),
        end_(ticks(std::min(length_cells, kLengthMaxCells))),
        exit_(std::min({next_x_, next_y_, end_})) {}

  static int cell_of(double x) { return static_cast<int>(std::floor(std::clamp(x, -kStartMax, kStartMax))); }
  /// Share of the cell that lies ahead.
  static double to_border(double x, double direction) {
    const double behind = x - std::floor(x);
    return direction < 0.0 ? behind : 1.0 - behind;
  }
  static std::int64_t ticks(double length_cells) {
    // A beam along an axis never reaches the other one's border: infinite, or 0/0 on it.
    const double scaled = length_cells * kTicksPerCell;
    return static_cast<std::int64_t>(scaled < kTicksMax ? scaled : kTicksMax);
  }
  static std::uint32_t parts(std::int64_t ticks) {
    return static_cast<std::uint32_t>((ticks + kTicksPerPart / 2) / kTicksPerPart);
  }
  static float cells(std::int64_t ticks) { return static_cast<float>(ticks) * static_cast<float>(1.0 / kTicksPerCell); }

  GridCell cell_;
  std::uint64_t step_x_;
  std::uint64_t step_y_;
  std::int64_t delta_x_;
  std::int64_t delta_y_;
  std::int64_t next_x_;
  std::int64_t next_y_;
  std::int64_t end_;
  std::int64_t enter_ = 0;
  std::int64_t exit_;
};

}  // namespace odoless
