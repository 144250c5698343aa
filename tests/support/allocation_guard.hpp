#pragma once

#include <cstdint>

#include "rt/heap_guard.hpp"

namespace odoless {

/// Counts the heap calls (malloc and its kin, free, operators new and delete) that the calling thread makes while the
/// guard lives. Guards may be nested.
///
/// Works in every test program, as they all link the interposed allocator (odoless_heap_guard); not under
/// AddressSanitizer or ThreadSanitizer, which do the same: there it counts nothing, and `kWorks` says so.
class AllocationGuard {
 public:
  static constexpr bool kWorks = ODOLESS_HEAP_CAN_BE_WATCHED == 1;

  /// Heap calls since construction.
  [[nodiscard]] std::int64_t calls() const { return heap_calls_on_this_thread() - calls_before_; }

 private:
  std::int64_t calls_before_ = heap_calls_on_this_thread();
};

}  // namespace odoless
