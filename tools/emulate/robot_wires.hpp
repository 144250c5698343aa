#pragma once

#include <cstdint>

#include "firmware/gpio/gpio_change.hpp"

namespace odoless {

/// What a robot's wires carry to the daemon. Pure: time goes in, levels come out.
///
/// Thread: one.
class RobotWires {
 public:
  RobotWires() = default;
  RobotWires(const RobotWires&) = delete;
  RobotWires& operator=(const RobotWires&) = delete;
  virtual ~RobotWires() = default;

  /// Lets time pass until `now_ns`. A pulse that is late by as much as it lasts is left out: late, it would be a lie.
  virtual void tick(std::int64_t now_ns) = 0;
  /// When a level changes next, or does for all that is known.
  [[nodiscard]] virtual std::int64_t next_event_ns() const = 0;
  /// The level of an input of the daemon's.
  [[nodiscard]] virtual bool is_high(GpioPin input) const = 0;
};

}  // namespace odoless
