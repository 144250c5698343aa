#pragma once

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define ODOLESS_COUNTS_HEAP_CALLS 0
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define ODOLESS_COUNTS_HEAP_CALLS 0
#endif
#endif
#ifndef ODOLESS_COUNTS_HEAP_CALLS
#define ODOLESS_COUNTS_HEAP_CALLS 1
#endif

namespace odoless {

/// Counts the heap calls (malloc and its kin, free, operators new and delete) that the calling thread makes while the
/// guard lives. Guards may be nested.
///
/// Works in every program that uses one, by standing in for the C library's functions; not under AddressSanitizer or
/// ThreadSanitizer, which do the same: there it counts nothing, and `kWorks` says so.
class AllocationGuard {
 public:
  static constexpr bool kWorks = ODOLESS_COUNTS_HEAP_CALLS == 1;

  AllocationGuard();

  /// Heap calls since construction.
  [[nodiscard]] long calls() const;

 private:
  long calls_before_;
};

}  // namespace odoless
