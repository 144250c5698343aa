#include "firmware/threads/intake.hpp"

#include <limits>

#include "firmware/stages/stage_reports.hpp"

namespace odoless {

Intake::Intake(Pipeline& pipeline, const Clock& clock, const LaserMountParams& mount, bool live, bool publish_scans)
    : pipeline_(pipeline),
      clock_(clock),
      publish_scans_(publish_scans),
      stage_(live, pipeline.pool.beams_max(), mount),
      free_(pipeline.pool.size()) {
  ranges_m_.reserve(static_cast<std::size_t>(pipeline.pool.beams_max()));
}

void Intake::reclaim() {
  for (ScanSlot slot = kNoSlot; pipeline_.slots_from_matcher.try_pop(slot);) {
    free_.give(slot);
  }
  for (ScanSlot slot = kNoSlot; pipeline_.slots_from_filter.try_pop(slot);) {
    free_.give(slot);
  }
}

bool Intake::has_room() {
  reclaim();
  return static_cast<std::size_t>(pipeline_.pool.size()) - free_.size() < pipeline_.scans.capacity();
}

void Intake::on_scan(const RawScan& scan) {
  reclaim();
  const ScanSlot slot = free_.take();
  if (slot == kNoSlot) {
    ++without_slot_;
    return;
  }
  if (stage_.process(scan, clock_.now_ns(), pipeline_.pool.at(slot)) != ScanVerdict::kAccepted) {
    free_.give(slot);
    return;
  }
  if (publish_scans_) {
    publish(scan);
  }
  if (tilt_ != nullptr && !tilt_->was_level_since(scan.stamp_ns)) {
    ++not_level_;
    free_.give(slot);
    return;
  }
  take(slot);
}

void Intake::take(ScanSlot slot) {
  if (const std::optional<ScanSlot> evicted = pipeline_.scans.push(slot)) {
    free_.give(*evicted);
  }
  pipeline_.matcher.wake.notify();
}

void Intake::publish(const RawScan& scan) {
  ScanRecord record;
  record.stamp_ns = scan.stamp_ns;
  record.start_angle_rad = scan.start_angle_rad;
  record.angle_step_rad = scan.angle_step_rad;
  record.beams = static_cast<std::int32_t>(scan.ranges_m.size());
  record.beam_period_ns = scan.beam_period_ns;
  ranges_m_.assign(scan.ranges_m.begin(), scan.ranges_m.end());
  for (float& range_m : ranges_m_) {
    const float known_m = range_m > 0.0F ? range_m : 0.0F;  // also of NaN
    range_m = known_m >= scan.no_return_m ? std::numeric_limits<float>::infinity() : known_m;
  }
  stage_.mask(scan, ranges_m_);
  send(pipeline_, pipeline_.sensor.outbox, RecordType::kScan, record, std::span<const float>(ranges_m_));
}

void Intake::on_raw(RawLine line, std::span<const std::byte> bytes, bool to_device) {
  RawBytesRecord record;
  record.stamp_ns = clock_.now_ns();
  record.size_bytes = static_cast<std::int32_t>(bytes.size());
  record.to_device = to_device ? 1 : 0;
  record.line = line;
  send(pipeline_, pipeline_.sensor.outbox, RecordType::kRawBytes, record, bytes);
}

void Intake::on_tilt(const TiltRecord& tilt) { send(pipeline_, pipeline_.sensor.outbox, RecordType::kTilt, tilt); }

void Intake::on_event(EventPriority priority, EventText text, std::int64_t number) {
  pipeline_.sensor.log.push(clock_.now_ns(), priority, text, number);
}

void Intake::report(const ScanSource& source, const TiltReport& tilt, const StageReport& stage) {
  SensorReport report;
  report.stage = stage;
  enter(stage_, report);
  source.add_counts(report.source);
  add_counts(report.source);
  report.source.dropped = static_cast<std::int64_t>(pipeline_.scans.evicted()) + without_slot_;
  report.open = source.is_open();
  report.tilt = tilt;
  report.tilt.held_back = not_level_;
  pipeline_.sensor.report.write(report);
}

}  // namespace odoless
