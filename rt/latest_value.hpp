#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>

namespace odoless {

/// The newest of what one thread says, for one other thread: a triple buffer.
///
/// Writer and reader own one buffer each; the third changes hands by one atomic exchange. A value that is overtaken by
/// a newer one before the reader asks is never seen.
///
/// Thread:    one writer (`back`, `publish`, `write`), one reader (`update`, `value`).
/// Real time: wait-free on both sides, no allocation, no system call; memory is three values.
///
/// @tparam T  Default constructible; not shared with another thread by pointers inside it.
template <class T>
class LatestValue {
 public:
  /// The reader sees `initial` until the first `update` that is true.
  explicit LatestValue(const T& initial = T()) : buffers_{Buffer{initial}, Buffer{initial}, Buffer{initial}} {}

  /// What the next `publish` shows. Holds an older value, not the last: fill in all of it.
  [[nodiscard]] T& back() { return buffers_[back_].value; }

  /// Shows `back()` to the reader, and gives the writer another.
  void publish() {
    // Release: after the value was written. Acquire: the buffer that comes back is written after the reader has read
    // it.
    back_ = middle_.exchange(back_ | kNew, std::memory_order_acq_rel) & kIndex;
  }

  void write(const T& value) {
    back() = value;
    publish();
  }

  /// Takes over what was published last; true if that is newer than `value()` was.
  bool update() {
    if ((middle_.load(std::memory_order_relaxed) & kNew) == 0) {
      return false;
    }
    // Release: after the old value was read. Acquire: the new one is read after the writer has written it.
    front_ = middle_.exchange(front_, std::memory_order_acq_rel) & kIndex;
    return true;
  }

  /// The value of the last `update`; it stays as it is until the next.
  [[nodiscard]] const T& value() const { return buffers_[front_].value; }

 private:
  static constexpr std::uint32_t kIndex = 3;
  static constexpr std::uint32_t kNew = 4;

  struct alignas(64) Buffer {  // a cache line is never written by both sides
    T value;
  };

  std::array<Buffer, 3> buffers_;
  alignas(64) std::uint32_t back_ = 0;                 ///< the writer's buffer
  alignas(64) std::uint32_t front_ = 1;                ///< the reader's buffer
  alignas(64) std::atomic<std::uint32_t> middle_ = 2;  ///< the third, with kNew while the reader hasn't taken it
};

}  // namespace odoless
