#include "rt/clock.hpp"

#include <algorithm>
#include <cerrno>
#include <ctime>
#include <limits>

namespace odoless {
namespace {

constexpr std::int64_t kSecond_ns = 1'000'000'000;

std::int64_t read_clock_ns(clockid_t clock) {
  timespec now{};
  clock_gettime(clock, &now);
  return static_cast<std::int64_t>(now.tv_sec) * kSecond_ns + now.tv_nsec;
}

/// Of several looks at both clocks, the one that took least: this thread may be interrupted between them.
std::int64_t read_epoch_ns() {
  std::int64_t epoch_ns = 0;
  std::int64_t least_ns = std::numeric_limits<std::int64_t>::max();
  for (int i = 0; i < 10; ++i) {
    const std::int64_t before_ns = read_clock_ns(CLOCK_MONOTONIC);
    const std::int64_t realtime_ns = read_clock_ns(CLOCK_REALTIME);
    const std::int64_t took_ns = read_clock_ns(CLOCK_MONOTONIC) - before_ns;
    if (took_ns < least_ns) {
      least_ns = took_ns;
      epoch_ns = realtime_ns - before_ns - took_ns / 2;
    }
  }
  return epoch_ns;
}

}  // namespace

MonotonicClock::MonotonicClock() : epoch_ns_(read_epoch_ns()) {}

std::int64_t MonotonicClock::now_ns() const { return epoch_ns_ + read_clock_ns(CLOCK_MONOTONIC); }

void MonotonicClock::sleep_until(std::int64_t stamp_ns) {
  const std::int64_t end_ns = std::max<std::int64_t>(stamp_ns - epoch_ns_, 0);
  const timespec end{.tv_sec = end_ns / kSecond_ns, .tv_nsec = end_ns % kSecond_ns};
  while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &end, nullptr) == EINTR) {
  }
}

void ManualClock::advance_to(std::int64_t stamp_ns) {
  std::int64_t now_ns = now_ns_.load();
  while (now_ns < stamp_ns && !now_ns_.compare_exchange_weak(now_ns, stamp_ns)) {
  }
}

void ReplayClock::sleep_until(std::int64_t stamp_ns) {
  if (rate_ > 0.0) {
    if (!start_) {
      start_ = {.log_ns = stamp_ns, .wall_ns = wall_.now_ns()};
    }
    const double ahead_ns = static_cast<double>(stamp_ns - start_->log_ns) / rate_;
    wall_.sleep_until(start_->wall_ns + static_cast<std::int64_t>(ahead_ns));
  }
  log_.advance_to(stamp_ns);
}

}  // namespace odoless
