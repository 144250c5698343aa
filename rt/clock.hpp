#pragma once

#include <atomic>
#include <cstdint>
#include <optional>

namespace odoless {

/// Where stamps come from: the machine, a test, or a recorded log.
///
/// Every clock: stamps never run backwards, and after `sleep_until(t)` it is `t` or later; a `t` that has passed
/// returns at once.
class Clock {
 public:
  Clock() = default;
  virtual ~Clock() = default;
  Clock(const Clock&) = delete;
  Clock& operator=(const Clock&) = delete;
  Clock(Clock&&) = delete;
  Clock& operator=(Clock&&) = delete;

  [[nodiscard]] virtual std::int64_t now_ns() const = 0;
  virtual void sleep_until(std::int64_t stamp_ns) = 0;
};

/// The machine's monotonic clock, counted from the Unix epoch: shifted once, at construction, by what the machine took
/// the time of day to be then. Set the time of day later, and these stamps go on as if nothing had happened.
///
/// Thread:    any, at the same time.
/// Real time: `now_ns` is one call of the vDSO; `sleep_until` is one system call (clock_nanosleep), more with signals.
class MonotonicClock final : public Clock {
 public:
  MonotonicClock();
  [[nodiscard]] std::int64_t now_ns() const override;
  void sleep_until(std::int64_t stamp_ns) override;

  /// The stamp of a moment of CLOCK_MONOTONIC, which the kernel stamps GPIO edges with.
  [[nodiscard]] std::int64_t from_monotonic_ns(std::int64_t monotonic_ns) const { return epoch_ns_ + monotonic_ns; }

 private:
  std::int64_t epoch_ns_;  ///< stamp of the moment when CLOCK_MONOTONIC was zero
};

/// Moves only when told, or slept on: a sleeper gets at once to the time that it wanted. For tests.
///
/// Thread: any, at the same time.
class ManualClock : public Clock {
 public:
  explicit ManualClock(std::int64_t start_ns = 0) : now_ns_(start_ns) {}
  [[nodiscard]] std::int64_t now_ns() const override { return now_ns_.load(); }
  void sleep_until(std::int64_t stamp_ns) override { advance_to(stamp_ns); }

  /// Moves forward; a stamp that has passed changes nothing.
  void advance_to(std::int64_t stamp_ns);
  void advance_by(std::int64_t duration_ns) { now_ns_.fetch_add(duration_ns); }

 private:
  std::atomic<std::int64_t> now_ns_;
};

/// Follows the stamps of a recorded log: it is as late as the latest stamp that was slept for.
///
/// The first stamp sets the pace: one that is later by `d` is reached after d / rate of real time.
///
/// Thread: `sleep_until` from one, which reads the log; `now_ns` from any.
class ReplayClock final : public Clock {
 public:
  /// @param rate  Recorded seconds per second; 0: as fast as possible, without any sleep.
  explicit ReplayClock(double rate) : rate_(rate) {}

  [[nodiscard]] std::int64_t now_ns() const override { return log_.now_ns(); }
  void sleep_until(std::int64_t stamp_ns) override;

 private:
  struct Pace {
    std::int64_t log_ns;
    std::int64_t wall_ns;
  };
  double rate_;
  std::optional<Pace> start_;
  MonotonicClock wall_;
  ManualClock log_;
};

}  // namespace odoless
