#include "firmware/publisher/map_store.hpp"

#include <algorithm>
#include <cmath>

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

bool MapStore::is_near(const MapTileRecord& tile, const Pose2& map_T_scan) const {
  const auto off_cells = [&](int at, double of_robot_m) {
    return std::abs((at + 0.5) * tile.size_cells - of_robot_m / geometry_.resolution_m);
  };
  return off_cells(tile.column, map_T_scan.x_m) <= 0.5 * geometry_.columns &&
         off_cells(tile.row, map_T_scan.y_m) <= 0.5 * geometry_.rows;
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

int MapStore::tiles(int side_cells) const {
  const auto over = [side_cells](const Extent& extent) { return (extent.size() + side_cells - 1) / side_cells; };
  return over(columns_) * over(rows_);
}

bool MapStore::next_tile(MapTileRecord& tile, std::span<std::uint8_t> cells) {
  const int side = tile.size_cells;
  const int columns = (columns_.size() + side - 1) / side;
  next_tile_ = next_tile_ + 1 < tiles(side) ? next_tile_ + 1 : 0;
  const int left = columns_.begin + next_tile_ % columns * side;
  const int lowest = rows_.begin + next_tile_ / columns * side;
  bool is_known = false;
  auto out = cells.begin();
  for (int row = lowest; row < lowest + side; ++row) {
    for (int column = left; column < left + side; ++column) {
      *out = row < rows_.end && column < columns_.end ? cell(column, row) : kUnknownCell;
      is_known |= *out++ != kUnknownCell;
    }
  }
  tile.column = left / side;
  tile.row = lowest / side;
  tile.cell_size_m = geometry_.resolution_m;
  return is_known;
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
  if (known.cells.empty()) {
    map.width_cells = map.height_cells = 1;
    map.occupancy_percent = {OccupancyMap::kUnknown};
    return map;
  }
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
