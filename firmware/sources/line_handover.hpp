#pragma once

#include <atomic>
#include <cstdint>

namespace odoless {

/// Carries a device's line between the supervisor, which may open and close it, and the sensor thread, which may read
/// and write it. One word says whose turn it is, and only who has the turn writes it.
///
/// Thread:    supervisor (`is_empty`, `offer`, `take_back`, `clear`), sensor thread (`take`, `give_back`).
/// Real time: wait-free, no system call.
class LineHandover {
 public:
  [[nodiscard]] bool is_empty() const {
    return word_.load(std::memory_order_relaxed).state == State::kEmpty;  // which the supervisor itself has written
  }

  /// Only where it is empty.
  void offer(int descriptor) {
    word_.store({State::kOffered, descriptor}, std::memory_order_release);  // after all that was done to open it
  }

  /// What is offered, which is then in use; -1: nothing.
  [[nodiscard]] int take() {
    Word word = word_.load(std::memory_order_relaxed);
    // In one step, as `clear` may come between. Acquire: what was done to open it comes before its first use.
    const bool is_taken = word.state == State::kOffered &&
                          word_.compare_exchange_strong(word, {State::kInUse, word.descriptor},
                                                        std::memory_order_acquire, std::memory_order_relaxed);
    return is_taken ? word.descriptor : -1;
  }

  /// Only of what was taken.
  void give_back(int descriptor) {
    word_.store({State::kReturned, descriptor}, std::memory_order_release);  // after its last use
  }

  /// What was given back, and then it is empty; -1: nothing.
  [[nodiscard]] int take_back() {
    const Word word = word_.load(std::memory_order_acquire);  // before it is closed
    if (word.state != State::kReturned) {
      return -1;
    }
    word_.store({State::kEmpty, -1}, std::memory_order_relaxed);
    return word.descriptor;
  }

  /// What lies here, offered or given back, and is not in use; -1: nothing. At the end, whether or not the sensor
  /// thread has ended.
  [[nodiscard]] int clear() {
    const Word word = word_.exchange({State::kEmpty, -1}, std::memory_order_acquire);  // as in `take_back`
    return word.state == State::kInUse ? -1 : word.descriptor;
  }

 private:
  enum class State : std::int32_t { kEmpty, kOffered, kInUse, kReturned };
  struct alignas(8) Word {  // as an atomic word has to be
    State state;
    std::int32_t descriptor;
  };
  static_assert(std::atomic<Word>::is_always_lock_free);

  std::atomic<Word> word_{Word{State::kEmpty, -1}};
};

}  // namespace odoless
