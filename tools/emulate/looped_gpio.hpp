#pragma once

#include <array>
#include <functional>
#include <optional>

#include "tools/emulate/device_loop.hpp"
#include "tools/emulate/gpio_sim_chip.hpp"
#include "tools/emulate/robot_wires.hpp"

namespace odoless {

/// A robot's wires on a chip: its levels are put on the pins, and what the daemon sets is told.
class LoopedGpio final : public LoopedDevice {
 public:
  /// A pin that the daemon drives has changed: power or light.
  using OnOutput = std::function<void(GpioPin pin, bool high, std::int64_t now_ns)>;

  /// Both must outlive it.
  LoopedGpio(RobotWires& wires, GpioSimChip& chip, OnOutput on_output);

  void step(std::int64_t now_ns) override;
  [[nodiscard]] pollfd waits_for() override { return {.fd = -1, .events = 0, .revents = 0}; }
  [[nodiscard]] std::int64_t next_event_ns() const override;

 private:
  static constexpr std::int64_t kLook_ns = 20'000'000;  ///< between looks at the pins

  void look(std::int64_t now_ns);

  RobotWires& wires_;
  GpioSimChip& chip_;
  OnOutput on_output_;
  std::array<bool, kGpioInputs> driven_{};
  std::array<bool, kGpioPinNames.size()> seen_{};
  std::int64_t next_look_ns_ = 0;
};

}  // namespace odoless
