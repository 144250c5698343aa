#include "drivers/tilt/tilt_ramp.hpp"

#include <algorithm>
#include <cmath>

namespace odoless {

// The speed from which it can come to rest at the target if it keeps it for this step yet: with a step of t, v of
// v t + v^2 / (2 a) = the way that is left.
double TiltRamp::step(double target_rad, double elapsed_s) {
  const double left_rad = target_rad - angle_rad_;
  const double change_radps = acceleration_radps2_ * elapsed_s;
  const double root_s = std::sqrt(elapsed_s * elapsed_s + 2.0 * std::abs(left_rad) / acceleration_radps2_);
  const double stoppable_radps = acceleration_radps2_ * (root_s - elapsed_s);
  const double wished_radps = std::copysign(std::min(stoppable_radps, speed_radps_), left_rad);
  velocity_radps_ += std::clamp(wished_radps - velocity_radps_, -change_radps, change_radps);
  angle_rad_ += velocity_radps_ * elapsed_s;
  return angle_rad_;
}

}  // namespace odoless
