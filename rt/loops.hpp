#pragma once

#include <atomic>
#include <cstdint>

#include "rt/clock.hpp"
#include "rt/stop_flag.hpp"
#include "rt/wake_up.hpp"

namespace odoless {

/// Runs a step at fixed times: start, start + period, start + 2 periods, ...
///
/// A step that ends after the next one was due is an overrun. The times that have passed by then are skipped and
/// counted, so that a late step isn't followed by a burst, and the later ones stay on the grid.
///
/// Thread:    `run` on one thread; counters from any.
/// Real time: per step one `now_ns` and one `sleep_until` of the clock; no allocation.
class PeriodicLoop {
 public:
  /// @param clock      Must outlive the loop.
  /// @param period_ns  At least 1.
  PeriodicLoop(Clock& clock, std::int64_t period_ns) : clock_(&clock), period_ns_(period_ns < 1 ? 1 : period_ns) {}

  /// Calls `step(due_ns)` at each time until `stop` is requested.
  template <class Step>
  void run(const StopFlag& stop, Step&& step) {
    std::int64_t due_ns = clock_->now_ns();
    while (!stop.requested()) {
      step(due_ns);
      due_ns = next_after(due_ns, clock_->now_ns());
      clock_->sleep_until(due_ns);
    }
  }

  /// Steps that took longer than to the next time.
  [[nodiscard]] std::uint64_t overruns() const { return overruns_.load(std::memory_order_relaxed); }

  /// Times that had no step.
  [[nodiscard]] std::uint64_t skipped() const { return skipped_.load(std::memory_order_relaxed); }

 private:
  std::int64_t next_after(std::int64_t due_ns, std::int64_t now_ns) {
    const std::int64_t late_periods = (now_ns - due_ns - 1) / period_ns_;  // a step may end just when the next is due
    if (late_periods > 0) {
      overruns_.fetch_add(1, std::memory_order_relaxed);
      skipped_.fetch_add(static_cast<std::uint64_t>(late_periods), std::memory_order_relaxed);
    }
    return due_ns + (late_periods + 1) * period_ns_;
  }

  Clock* clock_;
  std::int64_t period_ns_;
  std::atomic<std::uint64_t> overruns_ = 0;
  std::atomic<std::uint64_t> skipped_ = 0;
};

/// Runs a step whenever another thread has something for it. To end it: `stop.request()`, then `wake_up.notify()`.
///
/// Thread:    `run` on one thread.
/// Real time: two system calls per step (ppoll, read); no allocation.
class EventLoop {
 public:
  /// @param wake_up     Must outlive the loop.
  /// @param timeout_ns  A step without an event after this long; negative: never.
  explicit EventLoop(WakeUp& wake_up, std::int64_t timeout_ns = -1) : wake_up_(&wake_up), timeout_ns_(timeout_ns) {}

  /// Calls `step(notified)` after each event, time-out or signal until `stop` is requested.
  template <class Step>
  void run(const StopFlag& stop, Step&& step) {
    while (!stop.requested()) {
      const bool notified = wake_up_->wait(timeout_ns_);
      if (!stop.requested()) {
        step(notified);
      }
    }
  }

 private:
  WakeUp* wake_up_;
  std::int64_t timeout_ns_;
};

}  // namespace odoless
