#include "firmware/publisher/map_store.hpp"

#include <algorithm>

namespace odoless {

MapStore::MapStore(const GridGeometry& geometry)
    : geometry_(geometry),
      cells_(static_cast<std::size_t>(geometry.columns) * static_cast<std::size_t>(geometry.rows), kUnknownCell),
      column_min_(geometry.columns),
      row_min_(geometry.rows) {
  cut_.reserve(cells_.size());
}

void MapStore::update(const MapTileRecord& tile, std::span<const std::uint8_t> cells) {
  const int left = tile.column * tile.size_cells + geometry_.columns / 2;
  const int lowest = tile.row * tile.size_cells + geometry_.rows / 2;
  for (int row = std::max(lowest, 0); row < std::min(lowest + tile.size_cells, geometry_.rows); ++row) {
    for (int column = std::max(left, 0); column < std::min(left + tile.size_cells, geometry_.columns); ++column) {
      const auto from = static_cast<std::size_t>(row - lowest) * static_cast<std::size_t>(tile.size_cells) +
                        static_cast<std::size_t>(column - left);
      cells_[static_cast<std::size_t>(row) * static_cast<std::size_t>(geometry_.columns) +
             static_cast<std::size_t>(column)] = cells[from];
    }
  }
  column_min_ = std::clamp(left, 0, column_min_);
  row_min_ = std::clamp(lowest, 0, row_min_);
  column_end_ = std::clamp(left + tile.size_cells, column_end_, geometry_.columns);
  row_end_ = std::clamp(lowest + tile.size_cells, row_end_, geometry_.rows);
}

MapView MapStore::view(std::int64_t stamp_ns) {
  MapView view;
  view.stamp_ns = stamp_ns;
  view.cell_size_m = geometry_.resolution_m;
  view.lower_left_x_m = geometry_.origin_x_m() + column_min_ * geometry_.resolution_m;
  view.lower_left_y_m = geometry_.origin_y_m() + row_min_ * geometry_.resolution_m;
  view.columns = std::max(column_end_ - column_min_, 0);
  view.rows = std::max(row_end_ - row_min_, 0);
  cut_.clear();
  for (int row = row_min_; row < row_end_; ++row) {
    const auto* const first =
        cells_.data() + static_cast<std::size_t>(row) * static_cast<std::size_t>(geometry_.columns);
    cut_.insert(cut_.end(), first + column_min_, first + column_end_);
  }
  view.cells = cut_;
  return view;
}

MapSize MapStore::size() const {
  return {std::max(column_end_ - column_min_, 0) * geometry_.resolution_m,
          std::max(row_end_ - row_min_, 0) * geometry_.resolution_m, geometry_.resolution_m};
}

OccupancyMap MapStore::map() {
  const MapView known = view(0);
  OccupancyMap map;
  map.resolution_m = known.cell_size_m;
  map.origin_x_m = known.lower_left_x_m;
  map.origin_y_m = known.lower_left_y_m;
  map.width_cells = known.columns;
  map.height_cells = known.rows;
  for (const std::uint8_t cell : known.cells) {
    map.occupancy_percent.push_back(static_cast<std::int8_t>(cell));  // unknown: 255 is -1
  }
  return map;
}

}  // namespace odoless
