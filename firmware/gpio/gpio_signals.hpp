#pragma once

#include <atomic>
#include <cstdint>

#include "firmware/records/health.hpp"
#include "rt/rejecting_queue.hpp"

namespace odoless {

/// What the GPIO thread and the others tell each other. Wait-free on all sides.
struct GpioSignals {
  /// The emergency stop is pressed, or its line is lost, or was not read yet. Written by the GPIO thread, which wakes
  /// the sensor thread after each change; read by whoever moves something: nothing may move while it is set.
  std::atomic<bool> stopped{false};
  /// Of the lines that are configured, at least one cannot be used.
  std::atomic<bool> line_lost{false};
  /// Edges of the laser's sync pulse, on the stages' clock; from the GPIO thread to the sensor thread.
  RejectingQueue<std::int64_t> sync_pulses_ns{64};
  /// The last scans came without a pulse. Written by the sensor thread.
  std::atomic<bool> sync_missing{false};
  /// Arrival of the last scan, 0: none yet. Written by the sensor thread.
  std::atomic<std::int64_t> last_scan_ns{0};
  /// What the status light shows. Written by the supervisor.
  std::atomic<HealthState> state{HealthState::kInit};
  /// Times that the laser was switched off and on.
  std::atomic<std::int64_t> power_cycles{0};
};

}  // namespace odoless
