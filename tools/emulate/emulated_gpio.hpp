#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "tools/emulate/faults.hpp"
#include "tools/emulate/robot_wires.hpp"

namespace odoless {

/// What a robot's wires carry to the daemon: its emergency stop, low while it is pressed, and the pulse that its laser
/// gives at each turn. Only time goes in, levels come out. One thread.
///
/// Faults: stop: the emergency stop is pressed; silence: no pulses. Their times count from construction.
class EmulatedGpio final : public RobotWires {
 public:
  /// When pulse `index` is given, from 0, growing; far in the future: not known yet.
  using PulseTime = std::function<std::int64_t(std::int64_t index)>;

  /// @param pulse_ns  Empty: there are no pulses.
  EmulatedGpio(std::vector<Fault> faults, PulseTime pulse_ns, std::int64_t now_ns);

  void tick(std::int64_t now_ns) override;
  [[nodiscard]] std::int64_t next_event_ns() const override;
  [[nodiscard]] bool is_high(GpioPin input) const override;
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
