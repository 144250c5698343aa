#include "core/graph/world_map.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/slam/scan_beams.hpp"

namespace odoless {

namespace {

constexpr double kCells_max = 1e8;  // of what is written; beyond, cells are twice as large, and so on

}  // namespace

// The grid's centre is the map's origin, so that the farthest keyframe says how large it is.
void WorldMap::cover(const SubmapWorld& world) {
  constexpr double kNone_m = std::numeric_limits<double>::infinity();
  double reach_m = 0.0;
  Point2 least_m{kNone_m, kNone_m};
  Point2 most_m{-kNone_m, -kNone_m};
  for (std::size_t i = 0; i < world.submaps.size(); ++i) {
    const Submap& submap = world.submaps[i];
    for (int k = submap.first_keyframe; k < submap.first_keyframe + submap.keyframes; ++k) {
      const Pose2 map_T_scan = world.graph.pose(static_cast<int>(i)) * world.store.submap_T_scan(k);
      const double seen_m = world.store.farthest_m(k);
      reach_m = std::max({reach_m, std::abs(map_T_scan.x_m) + seen_m, std::abs(map_T_scan.y_m) + seen_m});
      least_m = {std::min(least_m.x_m, map_T_scan.x_m - seen_m), std::min(least_m.y_m, map_T_scan.y_m - seen_m)};
      most_m = {std::max(most_m.x_m, map_T_scan.x_m + seen_m), std::max(most_m.y_m, map_T_scan.y_m + seen_m)};
    }
  }
  const double area_m2 = reach_m > 0.0 ? (most_m.x_m - least_m.x_m) * (most_m.y_m - least_m.y_m) : 0.0;
  while (area_m2 > kCells_max * resolution_m_ * resolution_m_) {
    resolution_m_ *= 2.0;
  }
  const double tile_m = resolution_m_ * kTileSide_cells;
  side_tiles_ = 2 * (static_cast<int>(std::ceil(reach_m / tile_m)) + 1);
  geometry_ = {resolution_m_, side_tiles_ * kTileSide_cells, side_tiles_ * kTileSide_cells};
  tiles_.clear();
  tiles_.resize(static_cast<std::size_t>(side_tiles_) * static_cast<std::size_t>(side_tiles_));
}

Cell& WorldMap::at(const GridCell& cell) {
  const auto column = static_cast<std::size_t>(cell.column() >> kTileBits);
  const auto row = static_cast<std::size_t>(cell.row() >> kTileBits);
  std::unique_ptr<Tile>& tile = tiles_[row * static_cast<std::size_t>(side_tiles_) + column];
  if (!tile) {
    tile = std::make_unique<Tile>(std::size_t{kTileSide_cells} * kTileSide_cells);
  }
  return (*tile)[cell.index_in_tile<kTileBits>()];
}

void WorldMap::render(const SubmapWorld& world, const ScanParams& scan) {
  cover(world);
  const BeamModel model(beam_, resolution_m_);
  ScanFrame frame(scan);
  for (std::size_t i = 0; i < world.submaps.size(); ++i) {
    const Submap& submap = world.submaps[i];
    for (int k = submap.first_keyframe; k < submap.first_keyframe + submap.keyframes; ++k) {
      world.store.load(k, 1, frame);
      const Pose2 map_T_scan = world.graph.pose(static_cast<int>(i)) * world.store.submap_T_scan(k);
      integrate_scan(model, BeamCaster(geometry_, map_T_scan), *this, frame, 0.0);
    }
  }
}

const WorldMap::Tile* WorldMap::tile(int column, int row) const {
  return tiles_[static_cast<std::size_t>(row) * static_cast<std::size_t>(side_tiles_) +
                static_cast<std::size_t>(column)]
      .get();
}

void WorldMap::write(OccupancyMap& map) const {
  int first_column = side_tiles_;
  int first_row = side_tiles_;
  int end_column = 0;
  int end_row = 0;
  for (int row = 0; row < side_tiles_; ++row) {
    for (int column = 0; column < side_tiles_; ++column) {
      if (tile(column, row) != nullptr) {
        first_column = std::min(first_column, column);
        first_row = std::min(first_row, row);
        end_column = std::max(end_column, column + 1);
        end_row = std::max(end_row, row + 1);
      }
    }
  }
  map = OccupancyMap{};
  map.resolution_m = resolution_m_;
  if (end_column == 0) {
    return;
  }
  map.origin_x_m = geometry_.origin_x_m() + first_column * kTileSide_cells * resolution_m_;
  map.origin_y_m = geometry_.origin_y_m() + first_row * kTileSide_cells * resolution_m_;
  map.width_cells = (end_column - first_column) * kTileSide_cells;
  map.height_cells = (end_row - first_row) * kTileSide_cells;
  const auto rho_min_parts = static_cast<float>(beam_.rho_min_m / resolution_m_ * Cell::kParts);
  map.occupancy_percent.assign(static_cast<std::size_t>(map.width_cells) * static_cast<std::size_t>(map.height_cells),
                               OccupancyMap::kUnknown);
  for (std::size_t i = 0; i < map.occupancy_percent.size(); ++i) {
    const auto width = static_cast<std::size_t>(map.width_cells);
    const int column = first_column * kTileSide_cells + static_cast<int>(i % width);
    const int row = first_row * kTileSide_cells + static_cast<int>(i / width);
    const Tile* const at = tile(column >> kTileBits, row >> kTileBits);
    const Cell cell = at == nullptr ? Cell{} : (*at)[GridCell{column, row}.index_in_tile<kTileBits>()];
    if (!cell.is_unknown()) {
      map.occupancy_percent[i] = static_cast<std::int8_t>(cell.occupancy_percent(rho_min_parts));
    }
  }
}

}  // namespace odoless
