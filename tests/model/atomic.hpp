#pragma once

#include <cstring>
#include <type_traits>

#include "tests/model/explorer.hpp"

namespace odoless::model {

/// std::atomic, as the explorer sees it. As much of it as the checked headers use.
template <class T>
class Atomic {
  static_assert(std::is_trivially_copyable_v<T> && sizeof(T) <= sizeof(std::uint64_t));
  using Order = std::memory_order;

 public:
  static constexpr bool is_always_lock_free = std::atomic<T>::is_always_lock_free;

  Atomic() : Atomic(T()) {}
  Atomic(T value) : place_(Explorer::current().make_place(bits(value))) {}  // NOLINT: as std::atomic
  Atomic(const Atomic&) = delete;
  Atomic& operator=(const Atomic&) = delete;

  [[nodiscard]] bool is_lock_free() const { return is_always_lock_free; }

  T load(Order order = Order::seq_cst, Site site = Site::here()) const {
    return value(Explorer::current().load(place_, order, site));
  }

  void store(T desired, Order order = Order::seq_cst, Site site = Site::here()) {
    Explorer::current().store(place_, bits(desired), order, site);
  }

  T exchange(T desired, Order order = Order::seq_cst, Site site = Site::here()) {
    const auto change = [&](std::uint64_t) { return bits(desired); };
    return value(Explorer::current().exchange(place_, change, order, site));
  }

  T fetch_add(T more, Order order = Order::seq_cst, Site site = Site::here()) {
    const auto change = [&](std::uint64_t was) { return bits(static_cast<T>(value(was) + more)); };
    return value(Explorer::current().exchange(place_, change, order, site));
  }

  bool compare_exchange_strong(T& expected, T desired, Order success, Order failure, Site site = Site::here()) {
    const T was =
        value(Explorer::current().compare_exchange(place_, bits(expected), bits(desired), {success, failure}, site));
    const bool is_done = bits(was) == bits(expected);
    expected = was;
    return is_done;
  }

 private:
  static std::uint64_t bits(T value) {
    std::uint64_t bits = 0;
    std::memcpy(&bits, &value, sizeof(value));
    return bits;
  }
  static T value(std::uint64_t bits) {
    T value;
    std::memcpy(&value, &bits, sizeof(value));
    return value;
  }

  std::uint8_t place_;
};

inline void* copy_plain(void* to, const void* from, std::size_t size_bytes) {
  Explorer::current().touch(from, size_bytes, false);
  Explorer::current().touch(to, size_bytes, true);
  return std::memcpy(to, from, size_bytes);
}

/// Memory that is not atomic, and which two threads may not use at once.
template <class T>
class Plain {
 public:
  Plain() = default;
  Plain(T value) : value_(value) { touch(true); }  // NOLINT: as its value
  Plain(const Plain& other) : value_(other.get()) { touch(true); }
  Plain& operator=(const Plain& other) {
    const T value = other.get();
    touch(true);
    value_ = value;
    return *this;
  }
  ~Plain() = default;

  [[nodiscard]] T get() const {
    touch(false);
    return value_;
  }

 private:
  void touch(bool writes) const { Explorer::current().touch(this, sizeof(*this), writes); }

  alignas(8) T value_{};
};

}  // namespace odoless::model
