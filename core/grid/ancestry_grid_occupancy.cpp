#include <algorithm>

#include "core/base/check.hpp"
#include "core/grid/ancestry_grid.hpp"

namespace odoless {
namespace {

/// Inclusive bounds of the tiles that a particle knows.
struct TileBox {
  std::uint32_t column_min = UINT32_MAX;
  std::uint32_t column_max = 0;
  std::uint32_t row_min = UINT32_MAX;
  std::uint32_t row_max = 0;

  void include(std::uint32_t column, std::uint32_t row) {
    column_min = std::min(column_min, column);
    column_max = std::max(column_max, column);
    row_min = std::min(row_min, row);
    row_max = std::max(row_max, row);
  }
  [[nodiscard]] bool empty() const { return column_min > column_max; }
};

std::int8_t occupancy_percent(const Cell& cell, float rho_min_parts) {
  return cell.is_unknown() ? OccupancyMap::kUnknown : static_cast<std::int8_t>(cell.occupancy_percent(rho_min_parts));
}

}  // namespace

void AncestryGrid::write_occupancy(int particle, double rho_min_m, OccupancyMap& map) {
  TileBox box;
  for (std::uint32_t tile = 0; tile < first_of_tile_.size(); ++tile) {
    if (first_of_tile_[tile] != kNone && seen(tile, tree_.rank(particle)) != kBlank) {
      box.include(tile % tile_columns_, tile / tile_columns_);
    }
  }
  const int column = box.empty() ? 0 : static_cast<int>(box.column_min) * kTileSide_cells;
  const int row = box.empty() ? 0 : static_cast<int>(box.row_min) * kTileSide_cells;
  map.resolution_m = geometry_.resolution_m;
  map.origin_x_m = geometry_.origin_x_m() + column * geometry_.resolution_m;
  map.origin_y_m = geometry_.origin_y_m() + row * geometry_.resolution_m;
  map.width_cells = box.empty() ? 0 : (static_cast<int>(box.column_max) + 1) * kTileSide_cells - column;
  map.height_cells = box.empty() ? 0 : (static_cast<int>(box.row_max) + 1) * kTileSide_cells - row;
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
