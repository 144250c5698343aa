#include <algorithm>
#include <climits>

#include "core/base/check.hpp"
#include "core/grid/ancestry_grid.hpp"

namespace odoless {
namespace {

/// The cells of the tiles that a particle knows.
struct CellBox {
  int column_min = INT_MAX;
  int column_end = INT_MIN;
  int row_min = INT_MAX;
  int row_end = INT_MIN;

  void include_tile(const GridCell& corner) {
    column_min = std::min(column_min, corner.column());
    column_end = std::max(column_end, corner.column() + AncestryGrid::kTileSide_cells);
    row_min = std::min(row_min, corner.row());
    row_end = std::max(row_end, corner.row() + AncestryGrid::kTileSide_cells);
  }
  [[nodiscard]] bool empty() const { return column_min >= column_end; }
};

std::int8_t occupancy_percent(const Cell& cell, float rho_min_parts) {
  return cell.is_unknown() ? OccupancyMap::kUnknown : static_cast<std::int8_t>(cell.occupancy_percent(rho_min_parts));
}

}  // namespace

void AncestryGrid::write_occupancy(int particle, double rho_min_m, OccupancyMap& map) {
  CellBox box;
  for (std::uint32_t tile = 0; tile < first_of_tile_.size(); ++tile) {
    if (first_of_tile_[tile] != kNone && seen(tile, tree_.rank(particle)) != kBlank) {
      box.include_tile(corner_of(tile));
    }
  }
  const int column = box.empty() ? 0 : box.column_min;
  const int row = box.empty() ? 0 : box.row_min;
  map.resolution_m = geometry_.resolution_m;
  map.origin_x_m = geometry_.origin_x_m() + column * geometry_.resolution_m;
  map.origin_y_m = geometry_.origin_y_m() + row * geometry_.resolution_m;
  map.width_cells = box.empty() ? 0 : box.column_end - column;
  map.height_cells = box.empty() ? 0 : box.row_end - row;
  map.occupancy_percent.clear();
  map.occupancy_percent.reserve(static_cast<std::size_t>(map.width_cells) * static_cast<std::size_t>(map.height_cells));
  const auto rho_min_parts = static_cast<float>(rho_min_m / geometry_.resolution_m * Cell::kParts);
  View cells = view(particle);
  for (int y = row; y < row + map.height_cells; ++y) {
    for (int x = column; x < column + map.width_cells; ++x) {
      map.occupancy_percent.push_back(occupancy_percent(cells.at({x, y}), rho_min_parts));
    }
  }
}

bool AncestryGrid::write_square(int particle, double rho_min_m, GridCell corner, int side_cells,
                                std::span<std::uint8_t> percent) {
  ODOLESS_CHECK(percent.size() == static_cast<std::size_t>(side_cells) * static_cast<std::size_t>(side_cells));
  constexpr int kStep_cells = kTileSide_cells / 2;  // the corner may lie in the middle of a tile
  bool known = false;
  for (int y = 0; y < side_cells && !known; y += kStep_cells) {
    for (int x = 0; x < side_cells && !known; x += kStep_cells) {
      const std::uint32_t tile = tile_of({corner.column() + x, corner.row() + y});
      known = tile != kOutside && first_of_tile_[tile] != kNone && seen(tile, tree_.rank(particle)) != kBlank;
    }
  }
  const auto rho_min_parts = static_cast<float>(rho_min_m / geometry_.resolution_m * Cell::kParts);
  View cells = view(particle);
  for (std::size_t i = 0; known && i < percent.size(); ++i) {
    const auto column = static_cast<int>(i % static_cast<std::size_t>(side_cells));
    const auto row = static_cast<int>(i / static_cast<std::size_t>(side_cells));
    percent[i] = static_cast<std::uint8_t>(
        occupancy_percent(cells.at({corner.column() + column, corner.row() + row}), rho_min_parts));
  }
  return known;
}

}  // namespace odoless
