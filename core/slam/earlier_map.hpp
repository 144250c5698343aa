#pragma once

#include "core/grid/ancestry_grid.hpp"
#include "core/match/global_search.hpp"

namespace odoless {

/// A map as it was when a search read it: what has been mapped since is unknown. Only that can witness a pose which has
/// been in doubt since; what the robot maps from a wrong pose agrees with that pose for ever.
///
/// Thread: owned by one thread; valid as long as the view. Real time: no allocation, constant time per cell.
class EarlierMap {
 public:
  EarlierMap(AncestryGrid::View now, const GridGeometry& grid, const GlobalSearch& read)
      : now_(now), grid_(grid), read_(read) {}

  [[nodiscard]] const Cell& at(const GridCell& cell) {
    const Point2 p_map{grid_.origin_x_m() + (cell.column() + 0.5) * grid_.resolution_m,
                       grid_.origin_y_m() + (cell.row() + 0.5) * grid_.resolution_m};
    switch (read_.read(p_map)) {
      case ScoreRaster::Filled::kNot:
        return kUnknown;
      case ScoreRaster::Filled::kFree:
        return kFree;
      default:
        return now_.at(cell);
    }
  }

 private:
  static constexpr Cell kUnknown{};
  static constexpr Cell kFree{1, 0};

  AncestryGrid::View now_;
  const GridGeometry& grid_;
  const GlobalSearch& read_;
};

}  // namespace odoless
