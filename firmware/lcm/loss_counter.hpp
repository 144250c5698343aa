#pragma once

#include <array>
#include <cstdint>

namespace odoless {

/// Whoever sent a datagram: its address and port.
using SenderKey = std::uint64_t;

/// Counts lost datagrams from the sequence numbers of each sender, for as many senders as it has room for.
///
/// What it can say honestly: a gap in what one sender sent is lost until it arrives late. The first datagram of a
/// sender is its beginning; a jump by more than `kJumpMax` either way is a sender that started again. With more than
/// `kSenders` the one silent for longest is forgotten, and its losses in between with it.
///
/// Real time: no allocation, no system call; constant time.
class LossCounter {
 public:
  static constexpr int kSenders = 16;
  static constexpr std::int32_t kJumpMax = 10'000;

  void note(SenderKey key, std::uint32_t sequence);

  [[nodiscard]] std::int64_t lost() const { return lost_; }

 private:
  struct Sender {
    SenderKey key = 0;
    std::uint32_t expected = 0;
    std::int64_t missing = 0;
    std::int64_t heard_at = 0;  ///< count of all datagrams then; 0: the place is free
  };
  [[nodiscard]] Sender& place_of(SenderKey key);

  std::array<Sender, kSenders> senders_{};
  std::int64_t heard_ = 0;
  std::int64_t lost_ = 0;
};

}  // namespace odoless
