#pragma once

#include <cstddef>
#include <cstdint>

// 1 where the interposed allocator (target odoless_heap_guard) can be linked: not with a sanitizer that has its own.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define ODOLESS_HEAP_CAN_BE_WATCHED 0
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define ODOLESS_HEAP_CAN_BE_WATCHED 0
#endif
#endif
#ifndef ODOLESS_HEAP_CAN_BE_WATCHED
#define ODOLESS_HEAP_CAN_BE_WATCHED 1
#endif

namespace odoless {

/// True if this program has the interposed allocator, without which nothing below has an effect.
[[nodiscard]] bool heap_is_watched();

/// Heap calls (malloc and its kin, free, operators new and delete) of the calling thread since it started.
[[nodiscard]] std::int64_t heap_calls_on_this_thread();

/// From here on, a heap call of the calling thread says on standard error what it was and aborts the program.
///
/// Real time: sets a thread-local flag.
void forbid_heap_on_this_thread();

/// Forbids the heap to the calling thread while it lives. Guards may be nested.
class HeapGuard {
 public:
  HeapGuard();
  ~HeapGuard();
  HeapGuard(const HeapGuard&) = delete;
  HeapGuard& operator=(const HeapGuard&) = delete;
  HeapGuard(HeapGuard&&) = delete;
  HeapGuard& operator=(HeapGuard&&) = delete;

 private:
  bool was_forbidden_;
};

/// For the interposed allocator: counts the call, and aborts if the calling thread must not make it.
void note_heap_call(const char* function, std::size_t size_bytes);

}  // namespace odoless
