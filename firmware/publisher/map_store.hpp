#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/grid/grid_geometry.hpp"
#include "core/grid/occupancy_map.hpp"
#include "firmware/health/status.hpp"
#include "firmware/lcm/map_view.hpp"
#include "firmware/records/records.hpp"

namespace odoless {

/// The map as the publisher knows it from the filter's tiles.
///
/// Memory: one byte per cell of the whole grid, at construction. Thread: publisher thread.
class MapStore {
 public:
  explicit MapStore(const GridGeometry& geometry);

  void update(const MapTileRecord& tile, std::span<const std::uint8_t> cells);

  /// The part that is known; no cells while nothing is. Valid until the next call.
  [[nodiscard]] MapView view(std::int64_t stamp_ns);
  [[nodiscard]] OccupancyMap map();
  [[nodiscard]] MapSize size() const;

  [[nodiscard]] std::size_t memory_bytes() const { return 2 * cells_.capacity(); }

 private:
  GridGeometry geometry_;
  std::vector<std::uint8_t> cells_;  ///< of the whole grid, row by row
  std::vector<std::uint8_t> cut_;
  int column_min_, column_end_ = 0;  ///< the known part
  int row_min_, row_end_ = 0;
};

}  // namespace odoless
