#pragma once

#include <array>
#include <cmath>
#include <cstdint>

#include "core/motion/motion_increment.hpp"

namespace odoless {

/// The robot's speed as its last two displacements tell it, for the lambda of the scan-matching motion model.
///
/// Two, not one: a single match that missed its travel would otherwise say that the robot stood still.
/// Thread: owned by one thread. Real time: no allocation.
class TravelSpeed {
 public:
  /// lambda = |dt * V|: the travel that the speed before `increment` promises for its time, in metres; 0 before the
  /// first displacement.
  [[nodiscard]] double lambda_m(const MotionIncrement& increment) const {
    const double known_s = last_[0].time_s + last_[1].time_s;
    const double speed_mps = known_s > 0.0 ? (last_[0].travel_m + last_[1].travel_m) / known_s : 0.0;
    return speed_mps * duration_s(increment);
  }

  /// Takes an increment into the memory. One whose stamps do not advance tells no speed and is left out.
  void add(const MotionIncrement& increment) {
    const double time_s = duration_s(increment);
    if (time_s > 0.0) {
      const Pose2& motion = increment.previous_T_current;
      last_[0] = last_[1];
      last_[1] = {std::hypot(motion.x_m, motion.y_m), time_s};
    }
  }

  void reset() { last_ = {}; }

 private:
  struct Displacement {
    double travel_m = 0.0;
    double time_s = 0.0;
  };

  static double duration_s(const MotionIncrement& increment) {
    const std::int64_t duration_ns = increment.to_stamp_ns - increment.from_stamp_ns;
    return duration_ns > 0 ? static_cast<double>(duration_ns) * 1e-9 : 0.0;
  }

  std::array<Displacement, 2> last_{};
};

}  // namespace odoless
