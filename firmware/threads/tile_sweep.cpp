#include "firmware/threads/tile_sweep.hpp"

#include <algorithm>
#include <cmath>

namespace odoless {
namespace {

constexpr double kUsualPeriod_s = 0.1;

// That a window touches, wherever it lies.
int tiles_over(int cells) { return (cells + TileSweep::kSide_cells - 1) / TileSweep::kSide_cells + 1; }

int tile_at(int cell, int cells) {
  const int from_origin = cell - cells / 2;
  return (from_origin - (from_origin < 0 ? TileSweep::kSide_cells - 1 : 0)) / TileSweep::kSide_cells;
}

}  // namespace

TileSweep::TileSweep(FilterStage& stage, double refresh_s)
    : stage_(stage),
      refresh_s_(refresh_s),
      side_m_(kSide_cells * stage.geometry().resolution_m),
      columns_(tiles_over(stage.geometry().columns)),
      rows_(tiles_over(stage.geometry().rows)) {}

TileSweep::Index TileSweep::tile_of(const Pose2& map_T_scan) const {
  return {static_cast<int>(std::floor(map_T_scan.x_m / side_m_)),
          static_cast<int>(std::floor(map_T_scan.y_m / side_m_))};
}

void TileSweep::send(Outbox& outbox, const FilterStep& step, std::int64_t stamp_ns, std::int64_t period_ns) {
  if (step.updated) {
    send_tile(outbox, tile_of(step.map_T_scan), stamp_ns);
  }
  const double period_s = period_ns > 0 ? static_cast<double>(period_ns) * 1e-9 : kUsualPeriod_s;
  owed_ = std::min<double>(owed_ + columns_ * rows_ * period_s / refresh_s_, columns_ * rows_);
  const GridGeometry& window = stage_.geometry();
  const Index first{tile_at(window.first_column, window.columns), tile_at(window.first_row, window.rows)};
  int sent = 0;
  while (owed_ >= 1.0 && sent < kTilesPerScan_max) {
    const Index tile{first.column + next_ % columns_, first.row + next_ / columns_};
    sent += send_tile(outbox, tile, stamp_ns) ? 1 : 0;
    next_ = (next_ + 1) % (columns_ * rows_);
    owed_ -= 1.0;
  }
}

bool TileSweep::send_tile(Outbox& outbox, Index tile, std::int64_t stamp_ns) {
  constexpr std::size_t kCells = std::size_t{kSide_cells} * kSide_cells;
  const std::span<std::byte> room = outbox.reserve(RecordType::kMapTile, sizeof(MapTileRecord) + kCells);
  if (room.empty()) {
    return false;
  }
  const GridGeometry& geometry = stage_.geometry();
  const GridCell corner{tile.column * kSide_cells + geometry.columns / 2, tile.row * kSide_cells + geometry.rows / 2};
  auto* const cells = reinterpret_cast<std::uint8_t*>(room.data() + sizeof(MapTileRecord));
  if (!stage_.write_tile(corner, kSide_cells, std::span(cells, kCells))) {
    return false;  // nothing known there: the room is not committed
  }
  const MapTileRecord record{.stamp_ns = stamp_ns,
                             .column = tile.column,
                             .row = tile.row,
                             .size_cells = kSide_cells,
                             .cell_size_m = geometry.resolution_m};
  std::memcpy(room.data(), &record, sizeof(record));
  outbox.commit();
  return true;
}

}  // namespace odoless
