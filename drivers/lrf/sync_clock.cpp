#include "drivers/lrf/sync_clock.hpp"

#include <algorithm>
#include <cstdlib>
#include <limits>

namespace odoless {
namespace {

constexpr std::int64_t kNever_ns = std::numeric_limits<std::int64_t>::max();

}  // namespace

void SyncClock::on_pulse(std::int64_t stamp_ns) {
  if (count_ == 0 || stamp_ns > pulses_ns_[static_cast<std::size_t>(count_ - 1) % kPulses]) {
    pulses_ns_[static_cast<std::size_t>(count_++) % kPulses] = stamp_ns;
  }
}

// The median: neither a pulse that is missing nor one too many changes it.
std::int64_t SyncClock::usual_turn_ns() const {
  std::array<std::int64_t, kPulses> turns_ns{};
  std::size_t turns = 0;
  for (std::int64_t i = std::max<std::int64_t>(count_ - static_cast<std::int64_t>(kPulses), 0) + 1; i < count_; ++i) {
    const auto at = [&](std::int64_t index) { return pulses_ns_[static_cast<std::size_t>(index) % kPulses]; };
    turns_ns[turns++] = at(i) - at(i - 1);
  }
  if (turns == 0) {
    return 0;
  }
  std::int64_t* const middle = turns_ns.data() + turns / 2;
  std::nth_element(turns_ns.data(), middle, turns_ns.data() + turns);
  return *middle;
}

std::int64_t SyncClock::refine(std::int64_t stamp_ns) {
  std::int64_t nearest_ns = 0;
  std::int64_t error_ns = kNever_ns;
  for (std::size_t i = 0; i < std::min<std::size_t>(static_cast<std::size_t>(count_), kPulses); ++i) {
    const std::int64_t first_beam_ns = pulses_ns_[i] + delay_ns_;
    if (std::abs(first_beam_ns - stamp_ns) < error_ns) {
      nearest_ns = first_beam_ns;
      error_ns = std::abs(first_beam_ns - stamp_ns);
    }
  }
  const std::int64_t turn_ns = usual_turn_ns();
  const bool fits = turn_ns > 0 && error_ns <= turn_ns / 4;
  missed_in_a_row_ = fits ? 0 : missed_in_a_row_ + 1;
  return fits ? nearest_ns / 1000 * 1000 : stamp_ns;
}

}  // namespace odoless
