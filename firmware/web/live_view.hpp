#pragma once

#include <cstdint>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/grid/grid_geometry.hpp"
#include "firmware/health/status.hpp"
#include "firmware/records/records.hpp"
#include "firmware/web/trail.hpp"

namespace odoless {

/// What one browser has been told: nothing waits for it anywhere, so that a slow one costs no more than a fast one.
struct LiveCursor {
  std::int64_t last_ns = 0;  ///< 0: it has been told nothing
  double credit_bytes = 0.0;
  int map_number = -1;
  std::uint64_t pose = 0;
  std::uint64_t scan = 0;
  std::int64_t state_ns = 0;  ///< when it was told the state; 0: never
  std::uint32_t state_mark = 0;
  TrailCursor trail{};
  std::uint64_t tile = 0;
};

/// What the page shows, as known now: pose, scan, path, state, and the map in tiles. The publisher says what is new;
/// each browser is told what has changed since it was told last, however long ago, as events of text/event-stream.
///
/// Of the map it keeps as much as the filter's grid has, the newest tiles; a page keeps what it was told.
///
/// Memory: one byte per cell of the grid, and what else is needed, at construction. Thread: any; a lock is held only to
/// copy.
class LiveView {
 public:
  static constexpr double kRate_bytes_per_s = 180e3;  ///< that one browser is told at most, over some seconds

  explicit LiveView(const GridGeometry& geometry);

  void take(const PoseRecord& pose);
  void take(const MapTileRecord& tile, std::span<const std::uint8_t> cells);
  void take(const DaemonStatus& status);
  /// A scan, of which `pose` says where it was taken.
  void take(const PoseRecord& pose, const ScanRecord& scan, std::span<const float> ranges_m);

  /// Appends what is new for that browser, as much as it has credit for.
  void tell(LiveCursor& cursor, std::int64_t now_ns, std::string& events) const;

 private:
  struct TileIndex {
    int column = 0;
    int row = 0;
  };

  void clear_map(int map_number);
  void tell_beginning(LiveCursor& cursor, std::string& events) const;
  void tell_state(LiveCursor& cursor, std::int64_t now_ns, std::string& events) const;
  void tell_pose(LiveCursor& cursor, std::string& events) const;
  void tell_scan(LiveCursor& cursor, std::string& events) const;
  /// @return  Whether there was one.
  bool tell_tile(LiveCursor& cursor, std::string& events) const;
  [[nodiscard]] std::span<std::uint8_t> levels_of(std::size_t tile);

  mutable std::mutex mutex_;
  std::string run_;  ///< tells this run from others, so that a page knows when to begin anew
  double cell_size_m_;
  int tile_columns_;  ///< a tile's place is its column and row modulo these
  int tile_rows_;
  std::vector<TileIndex> tiles_;         ///< which one is at a place
  std::vector<std::uint64_t> versions_;  ///< of each tile; 0: nothing is known there
  std::uint64_t version_ = 0;            ///< of the tile that changed last
  std::vector<std::uint8_t> levels_;     ///< of the cells, tile after tile
  int map_number_ = 0;
  std::optional<DaemonStatus> status_;
  std::optional<PoseRecord> pose_;
  std::uint64_t poses_ = 0;
  Trail trail_;
  std::vector<Point2> scan_p_map_;
  std::uint64_t scans_ = 0;
  std::int64_t scan_stamp_ns_ = 0;
};

/// How occupied a cell is as the page has it: 0 to 15, and 16 where nothing is known.
[[nodiscard]] std::uint8_t level_of(std::uint8_t percent);

/// Appends levels as runs: a letter from 'a' on per level, and behind it how often it stands there, if more than once.
/// Never longer than the levels.
void append_runs(std::span<const std::uint8_t> levels, std::string& text);

}  // namespace odoless
