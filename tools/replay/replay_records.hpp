#pragma once

#include <cstdint>
#include <functional>
#include <span>

#include "firmware/health/health_monitor.hpp"
#include "firmware/publisher/map_store.hpp"
#include "firmware/stages/stage_reports.hpp"
#include "firmware/threads/tile_sweep.hpp"
#include "tools/replay/replay.hpp"

namespace odoless {

/// What the daemon would publish of a replay's scans, without its threads.
class ReplayRecords {
 public:
  using OnTile = std::function<void(const MapTileRecord&, std::span<const std::uint8_t>)>;

  explicit ReplayRecords(FilterStage& stage) : map_(stage.geometry()), tiles_(stage, kMapRefresh_s) {}

  /// Each scan, and what the stages made of it. @param on_tile  Called with each piece of the map; may be empty.
  void take(const ChainStep& step, const RawScan& raw, StageChain& chain, const OnTile& on_tile = {});

  /// Of the last scan.
  [[nodiscard]] const PoseRecord& pose() const { return pose_; }
  [[nodiscard]] const HealthReport& health() const { return health_; }
  [[nodiscard]] static ScanRecord scan(const RawScan& raw);
  [[nodiscard]] MapStore& map() { return map_; }

 private:
  static constexpr std::size_t kOutbox_bytes = std::size_t{1} << 20;
  static constexpr double kMapRefresh_s = 5.0;  // of recorded time

  MapStore map_;
  Outbox outbox_{kOutbox_bytes};
  TileSweep tiles_;
  HealthMonitor monitor_{HealthParams{}};
  SensorReport sensor_;
  MatcherReport matcher_;
  FilterReport filter_;
  PoseRecord pose_;
  HealthReport health_;
};

}  // namespace odoless
