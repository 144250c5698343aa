#pragma once

#include <algorithm>

#include "core/base/parameters.hpp"

namespace odoless {

/// What a person knows of how the robot, or whoever carries the laser, can move. The defaults fit a wheeled robot and a
/// person who walks.
struct RobotLimits {
  double speed_max_mps = 2.5;
  double turn_rate_max_radps = 7.0;
  double acceleration_max_mps2 = 4.5;
  double angular_acceleration_max_radps2 = 24.0;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.value("speed_max_mps", self.speed_max_mps, Range{0.01, 100.0}, "Largest speed in any direction.");
    visit.value("turn_rate_max_radps", self.turn_rate_max_radps, Range{0.01, 100.0}, "Largest turn rate.");
    visit.value("acceleration_max_mps2", self.acceleration_max_mps2, Range{0.01, 1000.0}, "Largest acceleration.");
    visit.value("angular_acceleration_max_radps2", self.angular_acceleration_max_radps2, Range{0.01, 10000.0},
                "Largest angular acceleration.");
  }
};

/// How far from where a constant velocity leads.
struct MotionReach {
  double distance_m = 0.0;
  double rotation_rad = 0.0;
};

/// How far the robot may be, after `time_s`, from where the velocity of its last motion leads: that velocity is known
/// as a mean over the scans before, so the acceleration acts for that time and this one; and it cannot change by more
/// than from full speed to full speed the other way.
[[nodiscard]] inline MotionReach reach_of(const RobotLimits& limits, double time_s) {
  return {time_s * std::min(limits.acceleration_max_mps2 * time_s, 2.0 * limits.speed_max_mps),
          time_s * std::min(limits.angular_acceleration_max_radps2 * time_s, 2.0 * limits.turn_rate_max_radps)};
}

}  // namespace odoless
