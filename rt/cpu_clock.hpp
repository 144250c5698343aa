#pragma once

#include <cstdint>

#include "core/base/deadline.hpp"

namespace odoless {

/// CPU time of the calling thread. Real time: one call of the vDSO or the kernel, no allocation.
[[nodiscard]] std::int64_t thread_cpu_ns();

/// CPU time of the whole process.
[[nodiscard]] std::int64_t process_cpu_ns();

/// The monotonic clock.
[[nodiscard]] std::int64_t monotonic_ns();

/// A deadline on the calling thread's CPU time.
class CpuDeadline {
 public:
  explicit CpuDeadline(std::int64_t budget_ns) : end_ns_(thread_cpu_ns() + budget_ns) {}

  /// A view of this deadline for the core; valid while this object lives, on the thread that made it.
  [[nodiscard]] Deadline view() const;

 private:
  std::int64_t end_ns_;
};

}  // namespace odoless
