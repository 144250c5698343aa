#pragma once

#include <cstdint>
#include <optional>

namespace odoless::cia402 {

/// States of a drive's power stage (CiA 402-2, figure "power drive system finite state automaton").
enum class PowerState : std::uint8_t {
  kNotReady,
  kSwitchOnDisabled,
  kReady,
  kSwitchedOn,
  kEnabled,
  kQuickStop,
  kFaultReaction,
  kFault,
};

/// Bits of the status word (6041h) beside the state.
enum StatusBit : std::uint16_t {
  kTargetReached = 1U << 10U,
  kInternalLimit = 1U << 11U,
  kSetPointAcknowledged = 1U << 12U,  ///< homing: attained
  kFollowingError = 1U << 13U,        ///< homing: error
};

/// Values and bits of the control word (6040h).
enum Control : std::uint16_t {
  kDisableVoltage = 0x00,
  kQuickStopControl = 0x02,
  kShutdown = 0x06,
  kSwitchOn = 0x07,
  kEnableOperation = 0x0F,
  kNewSetPoint = 0x10,  ///< homing: start
  kChangeAtOnce = 0x20,
  kFaultReset = 0x80,
};

/// The state that a status word tells; nothing for a word that none has.
[[nodiscard]] std::optional<PowerState> power_state(std::uint16_t status_word);

/// The control word that leads one step from `state` towards operation enabled. A fault's reset needs a rising edge:
/// it is kFaultReset where `last` is not, and 0 otherwise.
[[nodiscard]] std::uint16_t towards_enabled(PowerState state, std::uint16_t last);

/// The control word that stops the drive and keeps it so, from any state.
[[nodiscard]] std::uint16_t towards_stop(PowerState state);

}  // namespace odoless::cia402
