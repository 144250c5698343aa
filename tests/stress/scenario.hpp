#pragma once

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <thread>

namespace odoless::stress {

/// Two threads run at the same time; returns when both are done.
template <class Producer, class Consumer>
void run_both(Producer&& producer, Consumer&& consumer) {
  std::thread other(std::forward<Consumer>(consumer));
  producer();
  other.join();
}

/// Ends the program with status 1, saying what was broken.
inline void require(bool holds, const char* what) {
  if (!holds) {
    std::fprintf(stderr, "broken: %s\n", what);
    std::_Exit(1);
  }
}

/// A small generator (xorshift, Marsaglia 2003), so that the two sides meet in many ways.
class Chance {
 public:
  explicit Chance(std::uint64_t seed) : state_(seed) {}
  std::uint64_t below(std::uint64_t end) {
    state_ ^= state_ << 13;
    state_ ^= state_ >> 7;
    state_ ^= state_ << 17;
    return state_ % end;
  }

  /// Lets the other side run for a while, now and then.
  void pause() {
    if (below(64) == 0) {
      std::this_thread::yield();
    }
  }

 private:
  std::uint64_t state_;
};

}  // namespace odoless::stress
