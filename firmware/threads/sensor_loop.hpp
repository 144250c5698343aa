#pragma once

#include "firmware/sources/tilt_source.hpp"
#include "firmware/threads/intake.hpp"

namespace odoless {

/// The sensor thread: waits for the source and the tilt servo, lets them work, says how they are.
///
/// Real time: no allocation after construction; system calls: ppoll, those of both, and those of StageTimer,
/// WakeUp and getrusage.
class SensorLoop {
 public:
  SensorLoop(Pipeline& pipeline, ScanSource& source, Intake& intake, const Clock& clock, std::int64_t budget_ns);

  /// To be called before `run`, if at all: serves the tilt servo, too.
  void attach(TiltSource& tilt) { tilt_ = &tilt; }

  /// Until the pipeline stops or the source is at its end; then brings the servo to how it is to be left.
  void run();

 private:
  void wait();
  void end_tilt();

  static constexpr std::int64_t kTiltEnd_ns = 250'000'000;  ///< longest that the daemon's end waits for the servo

  Pipeline& pipeline_;
  ScanSource& source_;
  Intake& intake_;
  TiltSource* tilt_ = nullptr;
  const Clock& clock_;
  StageReport report_;
  StageTimer timer_;
  ThreadMeter meter_;
};

}  // namespace odoless
