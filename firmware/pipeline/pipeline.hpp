#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>

#include "config/robot_params.hpp"
#include "firmware/pipeline/messages.hpp"
#include "firmware/pipeline/outbox.hpp"
#include "firmware/pipeline/pipeline_params.hpp"
#include "firmware/pipeline/scan_pool.hpp"
#include "rt/event_ring.hpp"
#include "rt/evicting_queue.hpp"
#include "rt/latest_value.hpp"
#include "rt/rejecting_queue.hpp"
#include "rt/wake_up.hpp"

namespace odoless {

/// One stage's side of the pipeline: where it is woken, what it says, and whether it lives.
template <class Report>
struct StagePort {
  StagePort(std::size_t outbox_bytes, std::size_t events) : outbox(outbox_bytes), log{events} {}

  WakeUp wake;
  Outbox outbox;
  EventRing log;
  LatestValue<Report> report;
  std::atomic<std::uint64_t> heartbeat{0};  ///< counts the stage's rounds; the watchdog looks at it
  std::atomic<bool> done{false};            ///< the stage has drained its input and will not work any more
};

/// Everything between the threads: queues, pool, ports. Sized once, from the configuration.
///
///   sensor --scans--> matcher --motions--> filter       slots of scans come back from matcher and filter
///
/// A replay sets `lossless`: then no queue gives anything up; who finds one full waits for room.
struct Pipeline {
  Pipeline(const PipelineParams& params, const RobotParams& robot, bool lossless_replay);

  /// Records that found no room on their way to the publisher.
  [[nodiscard]] std::int64_t records_dropped() const;

  const bool lossless;
  ScanPool pool;
  EvictingQueue<ScanSlot> scans;
  RejectingQueue<MotionMessage> motions;
  RejectingQueue<ScanSlot> slots_from_matcher;
  RejectingQueue<ScanSlot> slots_from_filter;
  RejectingQueue<FilterCommand> commands;
  StagePort<SensorReport> sensor;
  StagePort<MatcherReport> matcher;
  StagePort<FilterReport> filter;
  Outbox gpio;                        ///< what is on the GPIO lines, from their thread
  std::atomic<bool> stopping{false};  ///< the sensor takes nothing in any more; the others drain
  /// What still waits is left where it is: the stages end after what they are at.
  std::atomic<bool> abandoning{false};
};

}  // namespace odoless
