#pragma once

#include <atomic>
#include <boost/lockfree/spsc_queue.hpp>
#include <cstddef>
#include <cstdint>

namespace odoless {

/// Bounded first-in first-out queue that refuses what it has no room for, and counts it.
///
/// The queue itself is boost::lockfree::spsc_queue; this adds the counters that every edge of the pipeline has.
///
/// Thread:    one producer (`try_push`), one consumer (`try_pop`); all counters from any thread.
/// Real time: wait-free, no system call; allocates in its constructor alone.
///
/// @tparam T  Copyable and default constructible; copying must not allocate.
template <class T>
class RejectingQueue {
 public:
  explicit RejectingQueue(std::size_t capacity) : queue_(capacity), capacity_(capacity) {}

  /// False if the queue is full: the value was not taken, which is counted.
  [[nodiscard]] bool try_push(const T& value) {
    if (!queue_.push(value)) {
      rejected_.store(rejected() + 1, std::memory_order_relaxed);
      return false;
    }
    const std::size_t size_now = size();
    if (size_now > high_water_.load(std::memory_order_relaxed)) {
      high_water_.store(size_now, std::memory_order_relaxed);
    }
    return true;
  }

  /// False if the queue is empty: `value` is as it was.
  [[nodiscard]] bool try_pop(T& value) { return queue_.pop(value); }

  [[nodiscard]] std::size_t capacity() const { return capacity_; }

  /// Exact for the producer and the consumer while the other rests; otherwise of a moment ago.
  [[nodiscard]] std::size_t size() const { return queue_.read_available(); }

  /// Values refused since construction.
  [[nodiscard]] std::uint64_t rejected() const { return rejected_.load(std::memory_order_relaxed); }

  /// The most values that were in the queue after a push.
  [[nodiscard]] std::size_t high_water() const { return high_water_.load(std::memory_order_relaxed); }

 private:
  boost::lockfree::spsc_queue<T> queue_;
  std::size_t capacity_;
  std::atomic<std::uint64_t> rejected_ = 0;
  std::atomic<std::size_t> high_water_ = 0;
};

}  // namespace odoless
