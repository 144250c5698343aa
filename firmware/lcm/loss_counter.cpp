#include "firmware/lcm/loss_counter.hpp"

#include <algorithm>

namespace odoless {

LossCounter::Sender& LossCounter::place_of(SenderKey key) {
  for (Sender& sender : senders_) {
    if (sender.heard_at != 0 && sender.key == key) {
      return sender;
    }
  }
  Sender& oldest = *std::min_element(senders_.begin(), senders_.end(),
                                     [](const Sender& a, const Sender& b) { return a.heard_at < b.heard_at; });
  oldest = {.key = key};
  return oldest;
}

void LossCounter::note(SenderKey key, std::uint32_t sequence) {
  Sender& sender = place_of(key);
  const auto ahead = static_cast<std::int32_t>(sequence - sender.expected);  // wraps around as the numbers do
  const bool known = sender.heard_at != 0 && ahead <= kJumpMax && ahead >= -kJumpMax;
  sender.heard_at = ++heard_;
  if (!known) {
    sender.expected = sequence + 1;
    sender.missing = 0;
    return;
  }
  if (ahead >= 0) {
    sender.missing += ahead;
    lost_ += ahead;
    sender.expected = sequence + 1;
  } else if (sender.missing > 0) {
    --sender.missing;  // late, not lost
    --lost_;
  }
}

}  // namespace odoless
