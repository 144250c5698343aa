#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "tools/emulate/faults.hpp"

namespace odoless {

/// The lines of a robot that isn't there, by their offset on the chip: the first two go to the daemon.
enum class RobotPin : std::uint8_t { kStop, kSync, kPower, kLed };
inline constexpr std::array<const char*, 4> kRobotPinNames{"stop", "sync", "power", "led"};
inline constexpr std::size_t kRobotInputs = 2;

/// What a robot's wires carry to the daemon: its emergency stop, low while it is pressed, and the pulse that its laser
/// gives at each turn. Only time goes in, levels come out. One thread.
///
/// Faults: stop: the emergency stop is pressed; silence: no pulses. Their times count from construction.
class EmulatedGpio {
 public:
  /// When pulse `index` is given, from 0, growing; far in the future: not known yet.
  using PulseTime = std::function<std::int64_t(std::int64_t index)>;

  /// @param pulse_ns  Empty: there are no pulses.
  EmulatedGpio(std::vector<Fault> faults, PulseTime pulse_ns, std::int64_t now_ns);

  /// Lets time pass until `now_ns`. A pulse that is late by as much as it lasts is left out: late, it would be a lie.
  void tick(std::int64_t now_ns);
  /// When a level changes next, or does for all that is known.
  [[nodiscard]] std::int64_t next_event_ns() const;
  [[nodiscard]] bool is_high(RobotPin input) const;
  [[nodiscard]] std::int64_t pulses() const { return pulses_; }

  static constexpr std::int64_t kPulse_ns = 2'000'000;

 private:
  std::vector<Fault> faults_;
  PulseTime pulse_ns_;
  std::int64_t start_ns_;
  std::int64_t now_ns_;
  std::int64_t next_pulse_ = 0;  ///< or the one that is high
  bool is_pulse_ = false;
  std::int64_t pulses_ = 0;
};

}  // namespace odoless
