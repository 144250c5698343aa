#pragma once

#include "firmware/threads/intake.hpp"

namespace odoless {

/// The sensor thread: waits for the source, lets it work, says how it is.
///
/// Real time: no allocation after construction; system calls: ppoll, those of the source, and those of StageTimer,
/// WakeUp and getrusage.
class SensorLoop {
 public:
  SensorLoop(Pipeline& pipeline, ScanSource& source, Intake& intake, const Clock& clock, std::int64_t budget_ns);

  /// Until the pipeline stops or the source is at its end.
  void run();

 private:
  void wait();

  Pipeline& pipeline_;
  ScanSource& source_;
  Intake& intake_;
  const Clock& clock_;
  StageReport report_;
  StageTimer timer_;
  ThreadMeter meter_;
};

}  // namespace odoless
