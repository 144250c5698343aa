#pragma once

#include <algorithm>
#include <array>

#include "core/math/elementary.hpp"
#include "core/motion/motion.hpp"

namespace odoless {

/// The robot's speed as its last two displacements tell it, for the lambda of the scan-matching motion model.
///
/// Two, not one: a single match that missed its travel would otherwise say that the robot stood still.
/// Thread: owned by one thread. Real time: no allocation.
class TravelSpeed {
 public:
  /// lambda = |dt * V|: the travel that the speed before `motion` promises for its time, in metres; 0 before the
  /// first displacement.
  [[nodiscard]] double lambda_m(const Motion& motion) const {
    const double known_s = last_[0].time_s + last_[1].time_s;
    const double speed_mps = known_s > 0.0 ? (last_[0].travel_m + last_[1].travel_m) / known_s : 0.0;
    return speed_mps * duration_s(motion);
  }

  /// Takes a motion into the memory. One that took no time tells no speed and is left out.
  void add(const Motion& motion) {
    const double time_s = duration_s(motion);
    if (time_s > 0.0) {
      last_[0] = last_[1];
      last_[1] = {math::hypot(motion.previous_T_current.x_m, motion.previous_T_current.y_m), time_s};
    }
  }

  void reset() { last_ = {}; }

 private:
  struct Displacement {
    double travel_m = 0.0;
    double time_s = 0.0;
  };

  static double duration_s(const Motion& motion) { return std::max(0.0, motion.duration_s()); }

  std::array<Displacement, 2> last_{};
};

}  // namespace odoless
