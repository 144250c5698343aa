#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <type_traits>

namespace odoless {

/// One block of memory, sized and touched at construction, from which spans are cut and never given back.
///
/// Thread:    one, at start; what it gave may be used by any.
/// Real time: `allocate` is a few instructions and the filling of the span; no system call. Running out is an empty
///            span, never the heap.
class Arena {
 public:
  /// @param capacity_bytes  Rounded up to pages. `capacity_bytes()` is 0 if the system has no room for it.
  explicit Arena(std::size_t capacity_bytes);
  ~Arena();
  Arena(const Arena&) = delete;
  Arena& operator=(const Arena&) = delete;
  Arena(Arena&&) = delete;
  Arena& operator=(Arena&&) = delete;

  /// @return  `count` values, each T(); empty if there is no room for all of them.
  template <class T>
  [[nodiscard]] std::span<T> allocate(std::size_t count) {
    static_assert(std::is_trivially_destructible_v<T>, "nobody destroys them");
    static_assert(std::is_nothrow_default_constructible_v<T>);
    if (count > capacity_bytes_ / sizeof(T)) {
      return {};
    }
    T* const first = static_cast<T*>(take(count * sizeof(T), alignof(T)));
    if (first == nullptr) {
      return {};
    }
    std::uninitialized_value_construct_n(first, count);
    return {first, count};
  }

  /// What was cut off, gaps for alignment included.
  [[nodiscard]] std::size_t used_bytes() const { return used_bytes_; }
  [[nodiscard]] std::size_t capacity_bytes() const { return capacity_bytes_; }

 private:
  void* take(std::size_t size_bytes, std::size_t alignment_bytes);

  std::byte* memory_ = nullptr;
  std::size_t capacity_bytes_ = 0;
  std::size_t used_bytes_ = 0;
};

}  // namespace odoless
