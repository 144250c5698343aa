#include "tools/replay/replay_records.hpp"

namespace odoless {

ScanRecord ReplayRecords::scan(const RawScan& raw) {
  return {.stamp_ns = raw.stamp_ns,
          .start_angle_rad = raw.start_angle_rad,
          .angle_step_rad = raw.angle_step_rad,
          .beams = static_cast<std::int32_t>(raw.ranges_m.size()),
          .beam_period_ns = raw.beam_period_ns};
}

void ReplayRecords::take(const ChainStep& step, const RawScan& raw, StageChain& chain, const OnTile& on_tile) {
  FilterStage& stage = chain.filter();
  const PoseEstimate estimate = stage.filter().estimate();
  pose_ = pose_record_of(step.filter, estimate, stage, step.stamp_ns);
  tiles_.send(outbox_, step.filter, step.stamp_ns, step.motion.to_stamp_ns - step.motion.from_stamp_ns);
  RecordRing& records = outbox_.ring();
  while (const auto record = records.front()) {
    const auto cells = elements_of<std::uint8_t, MapTileRecord>(record->bytes);
    map_.update(record_of<MapTileRecord>(record->bytes), cells);
    if (on_tile) {
      on_tile(record_of<MapTileRecord>(record->bytes), cells);
    }
    records.pop();
  }
  sensor_.open = true;
  sensor_.last_scan_ns = raw.stamp_ns;
  enter(chain.sensor(), sensor_);
  ++matcher_.stage.scans;
  ++filter_.stage.scans;
  enter(step.motion, matcher_);
  enter(step.filter, estimate, stage, filter_);
  health_ = monitor_.update(sensor_, matcher_, filter_, {}, raw.stamp_ns);
}

}  // namespace odoless
