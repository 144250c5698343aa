#pragma once

#include <algorithm>
#include <cstdint>
#include <ctime>

#include "firmware/pipeline/pipeline.hpp"
#include "rt/cpu_clock.hpp"
#include "rt/heap_guard.hpp"
#include "rt/memory_lock.hpp"

namespace odoless {

/// How long a stage with nothing to do sleeps before it says that it lives.
inline constexpr std::int64_t kIdle_ns = 50'000'000;
/// How long a stage of a lossless replay waits before it looks for room again.
inline constexpr std::int64_t kRoomWait_ns = 200'000;

/// One system call.
inline void sleep_ns(std::int64_t duration_ns) {
  const timespec duration{.tv_sec = duration_ns / 1'000'000'000, .tv_nsec = duration_ns % 1'000'000'000};
  static_cast<void>(clock_nanosleep(CLOCK_MONOTONIC, 0, &duration, nullptr));
}

/// Page faults and heap calls of the calling thread since its first question. Real time: one system call in 64
/// questions.
class ThreadMeter {
 public:
  void read(StageReport& report) {
    if (asked_++ % 64 == 0) {
      const ThreadFaults now = thread_page_faults();
      const std::int64_t faults = now.minor + now.major;
      if (asked_ == 1) {
        faults_before_ = faults;
        heap_calls_before_ = heap_calls_on_this_thread();
      }
      report.page_faults = faults - faults_before_;
    }
    report.allocations = watched_ ? heap_calls_on_this_thread() - heap_calls_before_ : -1;
  }

 private:
  bool watched_ = heap_is_watched();  // the question itself uses the heap
  std::int64_t asked_ = 0;
  std::int64_t faults_before_ = 0;
  std::int64_t heap_calls_before_ = 0;
};

/// Takes the time of a piece of work on the calling thread and enters it into a report.
class StageTimer {
 public:
  explicit StageTimer(std::int64_t budget_ns) : budget_ns_(budget_ns) {}

  void begin() {
    begin_ns_ = monotonic_ns();
    start_ns_ = thread_cpu_ns();
  }

  /// CPU time since `begin`.
  [[nodiscard]] std::int64_t used_ns() const { return thread_cpu_ns() - start_ns_; }

  /// @return  CPU time since `begin`.
  std::int64_t end(StageReport& report) const {
    const std::int64_t cpu_ns = used_ns();
    RoundTime& shortest = *std::ranges::min_element(report.longest, {}, &RoundTime::cpu_ns);
    if (cpu_ns > shortest.cpu_ns) {
      shortest = {begin_ns_, monotonic_ns(), cpu_ns};
    }
    report.cpu.record(cpu_ns);
    report.budget_ns = budget_ns_;
    report.deadline_misses += cpu_ns > budget_ns_ ? 1 : 0;
    ++report.scans;
    return cpu_ns;
  }

 private:
  std::int64_t budget_ns_;
  std::int64_t begin_ns_ = 0;
  std::int64_t start_ns_ = 0;
};

/// Sends a record; in a lossless replay waits until there is room, or the run is given up.
template <class Record, class Element = std::byte>
void send(Pipeline& pipeline, Outbox& outbox, RecordType type, const Record& record,
          std::span<const Element> elements = {}) {
  while (!outbox.send(type, record, elements) && pipeline.lossless && !pipeline.abandoning) {
    sleep_ns(kRoomWait_ns);
  }
}

}  // namespace odoless
