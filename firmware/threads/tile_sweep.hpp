#pragma once

#include <cstdint>

#include "firmware/pipeline/outbox.hpp"
#include "firmware/stages/filter_stage.hpp"

namespace odoless {

/// Sends the map piece by piece: with every scan a share of all tiles in turn, so that whoever listens has the whole
/// map after the refresh time, and after an update the tile that the robot is in.
///
/// Thread: filter thread. Real time: no allocation; a bounded number of tiles per scan. A tile that finds no room is
/// left out until its next turn.
class TileSweep {
 public:
  static constexpr int kSide_cells = 128;
  static constexpr int kTilesPerScan_max = 16;

  TileSweep(FilterStage& stage, double refresh_s);

  /// @param period_ns  Between scans; 0 or less: not known.
  void send(Outbox& outbox, const FilterStep& step, std::int64_t stamp_ns, std::int64_t period_ns);

 private:
  struct Index {
    int column = 0;
    int row = 0;
  };
  [[nodiscard]] Index tile_of(const Pose2& map_T_scan) const;
  /// @return  Whether there was something to send.
  bool send_tile(Outbox& outbox, Index tile, std::int64_t stamp_ns);

  FilterStage& stage_;
  double refresh_s_;
  double side_m_;
  int columns_;  ///< of tiles that the map's window touches
  int rows_;
  int next_ = 0;
  double owed_ = 0.0;  ///< tiles that are due
};

}  // namespace odoless
