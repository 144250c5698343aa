#include "drivers/tilt/cia402/power_state.hpp"

#include <algorithm>
#include <array>

namespace odoless::cia402 {
namespace {

struct Pattern {
  std::uint16_t mask;
  std::uint16_t value;
  PowerState state;
};

constexpr std::array<Pattern, 8> kPatterns{{
    {0x4F, 0x00, PowerState::kNotReady},
    {0x4F, 0x40, PowerState::kSwitchOnDisabled},
    {0x6F, 0x21, PowerState::kReady},
    {0x6F, 0x23, PowerState::kSwitchedOn},
    {0x6F, 0x27, PowerState::kEnabled},
    {0x6F, 0x07, PowerState::kQuickStop},
    {0x4F, 0x0F, PowerState::kFaultReaction},
    {0x4F, 0x08, PowerState::kFault},
}};

}  // namespace

std::optional<PowerState> power_state(std::uint16_t status_word) {
  const auto* const found = std::find_if(kPatterns.begin(), kPatterns.end(), [&](const Pattern& pattern) {
    return (status_word & pattern.mask) == pattern.value;
  });
  return found == kPatterns.end() ? std::nullopt : std::optional(found->state);
}

std::uint16_t towards_enabled(PowerState state, std::uint16_t last) {
  switch (state) {
    case PowerState::kNotReady:
    case PowerState::kFaultReaction:
      return kDisableVoltage;
    case PowerState::kSwitchOnDisabled:
      return kShutdown;
    case PowerState::kReady:
      return kSwitchOn;
    case PowerState::kSwitchedOn:
    case PowerState::kEnabled:
    case PowerState::kQuickStop:
      return kEnableOperation;
    case PowerState::kFault:
      return last == kFaultReset ? kDisableVoltage : kFaultReset;
  }
  return kDisableVoltage;
}

std::uint16_t towards_stop(PowerState state) {
  const bool moves = state == PowerState::kEnabled || state == PowerState::kQuickStop;
  return moves ? kQuickStopControl : kDisableVoltage;
}

}  // namespace odoless::cia402
