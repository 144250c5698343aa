#include "rt/cpu_clock.hpp"

#include <ctime>

namespace odoless {
namespace {

std::int64_t read_ns(clockid_t clock) {
  timespec now{};
  clock_gettime(clock, &now);
  return static_cast<std::int64_t>(now.tv_sec) * 1'000'000'000 + now.tv_nsec;
}

}  // namespace

std::int64_t thread_cpu_ns() { return read_ns(CLOCK_THREAD_CPUTIME_ID); }

std::int64_t process_cpu_ns() { return read_ns(CLOCK_PROCESS_CPUTIME_ID); }

std::int64_t monotonic_ns() { return read_ns(CLOCK_MONOTONIC); }

Deadline CpuDeadline::view() const {
  return {[](const void* end_ns) { return thread_cpu_ns() >= *static_cast<const std::int64_t*>(end_ns); }, &end_ns_};
}

}  // namespace odoless
