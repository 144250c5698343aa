#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/geometry/pose2.hpp"
#include "core/grid/grid_geometry.hpp"
#include "core/grid/occupancy_map.hpp"
#include "firmware/health/status.hpp"
#include "firmware/lcm/map_view.hpp"
#include "firmware/records/records.hpp"

namespace odoless {

/// The map as the publisher knows it from the filter's tiles: as much as the filter's grid has, around what came last.
///
/// Memory: one byte per cell of the grid, at construction. Thread: publisher thread.
class MapStore {
 public:
  explicit MapStore(const GridGeometry& geometry);

  void update(const MapTileRecord& tile, std::span<const std::uint8_t> cells);
  /// Whether a tile is as near to the robot as half the grid: one that is not would move the known part away from it.
  [[nodiscard]] bool is_near(const MapTileRecord& tile, const Pose2& map_T_scan) const;

  /// Tiles of that side that the known part touches.
  [[nodiscard]] int tiles(int side_cells) const;
  /// One after the other of them, again and again, whose side `tile` says.
  /// @return  Whether anything is known in it; else nothing is written.
  bool next_tile(MapTileRecord& tile, std::span<std::uint8_t> cells);

  /// The part that is known; no cells while nothing is. Valid until the next call.
  [[nodiscard]] MapView view(std::int64_t stamp_ns);
  /// The same as a map; one unknown cell while nothing is known.
  [[nodiscard]] OccupancyMap map();
  [[nodiscard]] MapSize size() const;

 private:
  /// Columns or rows from `begin` to before `end`, from the map's origin.
  struct Extent {
    int begin = 0;
    int end = 0;

    [[nodiscard]] int size() const { return end - begin; }
    /// Takes in these, and gives up the far end of what is more than `most`.
    void include(int first, int count, int most);
  };

  [[nodiscard]] std::uint8_t& cell(int column, int row);
  /// Forgets what only the old extents have.
  void forget(const Extent& old_columns, const Extent& old_rows);

  GridGeometry geometry_;
  std::vector<std::uint8_t> cells_;  ///< by column and row modulo those of the grid
  std::vector<std::uint8_t> cut_;
  Extent columns_;  ///< the known part
  Extent rows_;
  int next_tile_ = 0;
};

}  // namespace odoless
