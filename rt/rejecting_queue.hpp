#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace odoless {

/// Bounded first-in first-out queue that refuses what it has no room for, and counts it.
///
/// Head and tail only count up (64 bits: never twice the same), and an index modulo the capacity is a slot.
///
/// Thread:    one producer (`try_push`), one consumer (`try_pop`); all counters from any thread.
/// Real time: wait-free, no system call; allocates in its constructor alone.
///
/// @tparam T  Copyable and default constructible; copying must not allocate.
template <class T>
class RejectingQueue {
 public:
  explicit RejectingQueue(std::size_t capacity) : slots_(capacity) {}

  /// False if the queue is full: the value was not taken, which is counted.
  [[nodiscard]] bool try_push(const T& value) {
    const std::uint64_t tail = tail_.load(std::memory_order_relaxed);
    // Acquire: of the pop's release. The slot would be written while it is still read else.
    if (tail - head_.load(std::memory_order_acquire) == capacity()) {
      rejected_.store(rejected() + 1, std::memory_order_relaxed);
      return false;
    }
    slots_[tail % capacity()] = value;
    tail_.store(tail + 1, std::memory_order_release);  // after the value, which would be read unwritten else
    const std::size_t size_now = size();
    if (size_now > high_water_.load(std::memory_order_relaxed)) {
      high_water_.store(size_now, std::memory_order_relaxed);
    }
    return true;
  }

  /// False if the queue is empty: `value` is as it was.
  [[nodiscard]] bool try_pop(T& value) {
    const std::uint64_t head = head_.load(std::memory_order_relaxed);
    if (head == tail_.load(std::memory_order_acquire)) {  // of the push's release
      return false;
    }
    value = slots_[head % capacity()];
    head_.store(head + 1, std::memory_order_release);  // after the slot was read
    return true;
  }

  [[nodiscard]] std::size_t capacity() const { return slots_.size(); }

  /// Exact for the producer and the consumer while the other rests; otherwise of a moment ago.
  [[nodiscard]] std::size_t size() const {
    const std::uint64_t head = head_.load(std::memory_order_relaxed);
    const std::uint64_t tail = tail_.load(std::memory_order_relaxed);
    return tail > head ? tail - head : 0;  // a third thread may see the head of later than the tail
  }

  /// Values refused since construction.
  [[nodiscard]] std::uint64_t rejected() const { return rejected_.load(std::memory_order_relaxed); }

  /// The most values that were in the queue after a push.
  [[nodiscard]] std::size_t high_water() const { return high_water_.load(std::memory_order_relaxed); }

 private:
  // Each on a cache line of its own: head and tail are written by different processors.
  alignas(64) std::atomic<std::uint64_t> head_ = 0;  ///< index of the oldest value
  alignas(64) std::atomic<std::uint64_t> tail_ = 0;  ///< index of the next value
  std::atomic<std::uint64_t> rejected_ = 0;
  std::atomic<std::size_t> high_water_ = 0;
  std::vector<T> slots_;
};

}  // namespace odoless
