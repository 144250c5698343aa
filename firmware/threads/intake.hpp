#pragma once

#include <cstdint>
#include <vector>

#include "firmware/pipeline/pipeline.hpp"
#include "firmware/records/records.hpp"
#include "firmware/sources/tilt_source.hpp"
#include "firmware/stages/scan_source.hpp"
#include "firmware/stages/sensor_stage.hpp"
#include "firmware/threads/round.hpp"
#include "rt/clock.hpp"

namespace odoless {

/// Takes a source's scans into the pool, tells the publisher of them, and hands them to the matcher.
///
/// Thread: sensor thread. Real time: no allocation after construction; the system call of WakeUp::notify per scan.
class Intake : public ScanSink {
 public:
  /// @param publish_scans  Whether scans go to the publisher; not those that came from there.
  Intake(Pipeline& pipeline, const Clock& clock, const LaserMountParams& mount, bool live, bool publish_scans);
  virtual ~Intake() = default;

  void on_scan(const RawScan& scan) final;
  void on_raw(RawLine line, std::span<const std::byte> bytes, bool to_device) final;
  void on_tilt(const TiltRecord& tilt) final;
  void on_event(EventPriority priority, EventText text, std::int64_t number) final;
  void on_motion(const Motion& /*motion*/) override {}

  /// To be called before the thread starts, if at all: scans that the servo's laser took while it was not level go to
  /// the publisher, and not to 2D SLAM.
  void attach(const TiltSource& tilt) { tilt_ = &tilt; }

  /// Whether one more scan can be taken in without loss.
  [[nodiscard]] bool has_room();
  void report(const ScanSource& source, const TiltReport& tilt, const StageReport& stage);

 protected:
  /// A scan that was accepted.
  virtual void take(ScanSlot slot);
  /// What the intake itself counts.
  virtual void add_counts(SourceHealth& /*health*/) const {}
  void give_back(ScanSlot slot) { free_.give(slot); }
  [[nodiscard]] Pipeline& pipeline() { return pipeline_; }

 private:
  void publish(const RawScan& scan);
  void reclaim();

  Pipeline& pipeline_;
  const Clock& clock_;
  bool publish_scans_;
  SensorStage stage_;
  FreeSlots free_;
  const TiltSource* tilt_ = nullptr;
  std::int64_t without_slot_ = 0;
  std::int64_t not_level_ = 0;
  std::vector<float> ranges_m_;
};

}  // namespace odoless
