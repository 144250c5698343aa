#include "drivers/tilt/angle_gate.hpp"

#include <cmath>

namespace odoless {

bool AngleGate::follows(std::int64_t stamp_ns, double angle_rad, std::int64_t before_ns, double before_rad) const {
  const double elapsed_s = static_cast<double>(stamp_ns - before_ns) * 1e-9;
  return std::abs(angle_rad - before_rad) <= kSlackRad + speed_max_radps_ * elapsed_s;
}

bool AngleGate::passes(std::int64_t stamp_ns, double angle_rad) {
  if (!started_ || follows(stamp_ns, angle_rad, last_ns_, last_rad_)) {
    suspects_ = 0;
  } else {
    const bool fits = suspects_ > 0 && follows(stamp_ns, angle_rad, suspect_ns_, suspect_rad_);
    suspects_ = fits ? suspects_ + 1 : 1;
    suspect_ns_ = stamp_ns;
    suspect_rad_ = angle_rad;
    if (suspects_ < kConfirmations) {
      return false;
    }
    suspects_ = 0;
  }
  started_ = true;
  last_ns_ = stamp_ns;
  last_rad_ = angle_rad;
  return true;
}

}  // namespace odoless
