#include "firmware/publisher/map_store.hpp"

#include <algorithm>

namespace odoless {
namespace {

std::size_t place(int at, int most) { return static_cast<std::size_t>(at % most + (at % most < 0 ? most : 0)); }

}  // namespace

MapStore::MapStore(const GridGeometry& geometry)
    : geometry_(geometry),
      cells_(static_cast<std::size_t>(geometry.columns) * static_cast<std::size_t>(geometry.rows), kUnknownCell) {
  cut_.reserve(cells_.size());
}

void MapStore::Extent::include(int first, int count, int most) {
  const Extent before = size() > 0 ? *this : Extent{first, first};
  begin = std::min(before.begin, first);
  end = std::max(before.end, first + count);
  if (size() > most) {
    begin = end > before.end ? end - most : begin;
    end = begin + most;
  }
}

std::uint8_t& MapStore::cell(int column, int row) {
  return cells_[place(row, geometry_.rows) * static_cast<std::size_t>(geometry_.columns) +
                place(column, geometry_.columns)];
}

void MapStore::forget(const Extent& old_columns, const Extent& old_rows) {
  const auto has = [](const Extent& extent, int at) { return at >= extent.begin && at < extent.end; };
  for (int row = old_rows.begin; row < old_rows.end; ++row) {
    for (int column = old_columns.begin; column < old_columns.end; ++column) {
      if (!has(rows_, row) || !has(columns_, column)) {
        cell(column, row) = kUnknownCell;
      }
    }
  }
}

void MapStore::update(const MapTileRecord& tile, std::span<const std::uint8_t> cells) {
  const int left = tile.column * tile.size_cells;
  const int lowest = tile.row * tile.size_cells;
  const Extent old_columns = columns_;
  const Extent old_rows = rows_;
  columns_.include(left, tile.size_cells, geometry_.columns);
  rows_.include(lowest, tile.size_cells, geometry_.rows);
  if (columns_.begin > old_columns.begin || columns_.end < old_columns.end || rows_.begin > old_rows.begin ||
      rows_.end < old_rows.end) {
    forget(old_columns, old_rows);
  }
  for (int row = std::max(lowest, rows_.begin); row < std::min(lowest + tile.size_cells, rows_.end); ++row) {
    for (int column = std::max(left, columns_.begin); column < std::min(left + tile.size_cells, columns_.end);
         ++column) {
      cell(column, row) = cells[static_cast<std::size_t>(row - lowest) * static_cast<std::size_t>(tile.size_cells) +
                                static_cast<std::size_t>(column - left)];
    }
  }
}

MapView MapStore::view(std::int64_t stamp_ns) {
  cut_.clear();
  for (int row = rows_.begin; row < rows_.end; ++row) {
    for (int column = columns_.begin; column < columns_.end; ++column) {
      cut_.push_back(cell(column, row));
    }
  }
  return {.stamp_ns = stamp_ns,
          .lower_left_x_m = columns_.begin * geometry_.resolution_m,
          .lower_left_y_m = rows_.begin * geometry_.resolution_m,
          .cell_size_m = geometry_.resolution_m,
          .columns = columns_.size(),
          .rows = rows_.size(),
          .cells = cut_};
}

MapSize MapStore::size() const {
  return {columns_.size() * geometry_.resolution_m, rows_.size() * geometry_.resolution_m, geometry_.resolution_m};
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
