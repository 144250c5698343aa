#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace odoless {

/// Bounded first-in first-out queue of small tokens that makes room for the newest by giving up the oldest.
///
/// Who pushes gets the evicted token back, so that what it stands for (a slot of a pool) is never lost: each token that
/// was pushed comes out exactly once, from `push` or from `try_pop`.
///
/// Head and tail only count up (64 bits: never twice the same), and an index modulo the capacity is a slot. Both sides
/// take the oldest by a compare-and-swap of the head after they read its slot, so that a token read from a slot that
/// changed hands in between is thrown away with the failed swap.
///
/// Thread:    one producer (`push`), one consumer (`try_pop`); all counters from any thread.
/// Real time: `push` is wait-free: if its swap fails, the consumer has just made the room. `try_pop` is lock-free: it
///            begins again only when the producer evicted in between. Allocates in its constructor alone.
///
/// @tparam T  Trivially copyable, and small enough for the processor to read and write at once.
template <class T>
class EvictingQueue {
  static_assert(std::atomic<T>::is_always_lock_free);

 public:
  /// @param capacity  Tokens that fit in; 0 is taken as 1.
  explicit EvictingQueue(std::size_t capacity) : slots_(capacity == 0 ? 1 : capacity) {}

  /// @return  The oldest token if the queue was full.
  std::optional<T> push(T token) {
    std::optional<T> evicted;
    const std::uint64_t tail = tail_.load(std::memory_order_relaxed);
    // Acquire, here and where the swap fails: who finds room sees what the consumer did before it made that. A pool
    // would lack a slot else, as the one that was given back before is not seen yet.
    std::uint64_t head = head_.load(std::memory_order_acquire);
    if (tail - head == capacity()) {
      const T oldest = slot(head).load(std::memory_order_relaxed);
      // Release: a head that was moved here comes with the tail of that time. The consumer would see a tail behind the
      // head else, and take what is not there.
      if (head_.compare_exchange_strong(head, head + 1, std::memory_order_release, std::memory_order_acquire)) {
        evicted = oldest;
        evicted_.store(this->evicted() + 1, std::memory_order_relaxed);
      }
    }
    slot(tail).store(token, std::memory_order_relaxed);
    // Release: after the token and what it stands for. The consumer would read them unwritten else.
    tail_.store(tail + 1, std::memory_order_release);
    note_size(tail + 1 - head_.load(std::memory_order_relaxed));
    return evicted;
  }

  /// @return  The oldest token, if there is one.
  std::optional<T> try_pop() {
    std::uint64_t head = head_.load(std::memory_order_acquire);  // of the eviction's release
    while (head != tail_.load(std::memory_order_acquire)) {      // of the push's release
      const T oldest = slot(head).load(std::memory_order_relaxed);
      // Release: after the slot was read, and after all that was given back. Acquire: of the eviction's release.
      if (head_.compare_exchange_strong(head, head + 1, std::memory_order_release, std::memory_order_acquire)) {
        return oldest;
      }
    }
    return std::nullopt;
  }

  [[nodiscard]] std::size_t capacity() const { return slots_.size(); }

  /// Tokens given back by `push` since construction.
  [[nodiscard]] std::uint64_t evicted() const { return evicted_.load(std::memory_order_relaxed); }

  /// The most tokens that were in the queue after a push.
  [[nodiscard]] std::size_t high_water() const { return high_water_.load(std::memory_order_relaxed); }

 private:
  std::atomic<T>& slot(std::uint64_t index) { return slots_[index % slots_.size()]; }

  void note_size(std::size_t size) {
    if (size > high_water_.load(std::memory_order_relaxed)) {
      high_water_.store(size, std::memory_order_relaxed);
    }
  }

  // Each on a cache line of its own: head and tail are written by different processors.
  alignas(64) std::atomic<std::uint64_t> head_ = 0;  ///< index of the oldest token
  alignas(64) std::atomic<std::uint64_t> tail_ = 0;  ///< index of the next token
  std::atomic<std::uint64_t> evicted_ = 0;
  std::atomic<std::size_t> high_water_ = 0;
  std::vector<std::atomic<T>> slots_;
};

}  // namespace odoless
