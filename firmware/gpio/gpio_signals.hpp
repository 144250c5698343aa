#pragma once

#include <atomic>
#include <cstdint>

#include "firmware/records/health.hpp"
#include "rt/rejecting_queue.hpp"

namespace odoless {

/// What the GPIO thread and the others tell each other. Wait-free on all sides.
struct GpioSignals {
  /// Longest round of the GPIO thread, three of its own: then what it said is not believed any more. With the 100 ms
  /// that it takes to slow down, a servo stands within 200 ms of an edge that nobody saw.
  static constexpr std::int64_t kRoundMax_ns = 60'000'000;

  /// The GPIO thread does not come round: a call on a line hangs, or it gets no processor.
  [[nodiscard]] bool is_silent(std::int64_t now_ns) const {
    const std::int64_t last_ns = round_ns.load(std::memory_order_acquire);
    return last_ns != 0 && now_ns - last_ns > kRoundMax_ns;
  }
  /// Nothing may move; also where nobody looks at the stop line.
  [[nodiscard]] bool is_stopped(std::int64_t now_ns) const {
    return stopped.load(std::memory_order_acquire) || (has_stop_line && is_silent(now_ns));
  }

  /// Whether there is an emergency stop. Written before the threads start.
  bool has_stop_line = false;
  /// When the GPIO thread last began a round that it has ended, 0: there is no such thread. Written by it.
  std::atomic<std::int64_t> round_ns{0};
  /// The emergency stop is pressed, or its line is lost, or was not read yet. Written by the GPIO thread, which wakes
  /// the sensor thread after each change; who moves something asks `is_stopped`.
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
