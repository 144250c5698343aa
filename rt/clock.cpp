#include "rt/clock.hpp"

#include <algorithm>
#include <cerrno>
#include <ctime>

namespace odoless {
namespace {

constexpr std::int64_t kSecond_ns = 1'000'000'000;

std::int64_t read_ns(clockid_t clock) {
  timespec now{};
  clock_gettime(clock, &now);
  return static_cast<std::int64_t>(now.tv_sec) * kSecond_ns + now.tv_nsec;
}

}  // namespace

MonotonicClock::MonotonicClock() : epoch_ns_(read_ns(CLOCK_REALTIME) - read_ns(CLOCK_MONOTONIC)) {}

std::int64_t MonotonicClock::now_ns() const { return epoch_ns_ + read_ns(CLOCK_MONOTONIC); }

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
