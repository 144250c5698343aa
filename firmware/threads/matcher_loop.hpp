#pragma once

#include <cstdint>

#include "core/base/deadline.hpp"
#include "firmware/pipeline/pipeline.hpp"
#include "firmware/stages/matcher_stage.hpp"
#include "firmware/threads/round.hpp"

namespace odoless {

/// The matcher thread: takes waiting scans, oldest first, and gives motions to the filter. While the filter's queue is
/// full, motions are added up and the newest scan stands for all.
///
/// Real time: no allocation after construction; system calls: those of WakeUp, the CPU clock, and getrusage.
class MatcherLoop {
 public:
  /// @param to_filter  Whether a filter thread takes the motions; otherwise they are published only.
  MatcherLoop(Pipeline& pipeline, MatcherStage& stage, std::int64_t budget_ns, bool to_filter);

  /// Until the sensor is done and all its scans are.
  void run();

 private:
  void process(ScanSlot slot);
  void publish(const Motion& motion);
  void hand_on(MotionMessage message);
  void give_back(ScanSlot slot);
  [[nodiscard]] bool push(const MotionMessage& message);
  void flush();
  void report(const Motion& motion);

  Pipeline& pipeline_;
  MatcherStage& stage_;
  std::int64_t budget_ns_;
  bool to_filter_;
  MotionMessage pending_;  ///< has a slot while the filter's queue is full
  MatcherReport report_;
  StageTimer timer_;
  ThreadMeter meter_;
};

}  // namespace odoless
