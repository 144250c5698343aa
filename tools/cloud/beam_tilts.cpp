#include "tools/cloud/beam_tilts.hpp"

#include <cmath>
#include <limits>

namespace odoless {

BeamTilts::BeamTilts(const TiltLog& log, const ServoParams& servo, double gap_max_s)
    : angles_(log.angles.size(), std::llround(gap_max_s * 1e9)) {
  for (const ServoAngle& angle : log.angles) {
    const double from_level_rad = angle.angle_rad - servo.level_rad;
    static_cast<void>(
        angles_.add(angle.stamp_ns - servo.clock_ahead_ns, servo.inverted ? -from_level_rad : from_level_rad));
  }
}

std::span<const double> BeamTilts::of(const LogScan& scan) {
  tilts_rad_.clear();
  for (std::size_t i = 0; i < scan.ranges_m.size(); ++i) {
    const Result<double> tilt =
        angles_.at(scan.stamp_ns + scan.first_beam_ns + static_cast<std::int64_t>(i) * scan.beam_period_ns);
    tilts_rad_.push_back(tilt.ok() ? tilt.value() : std::numeric_limits<double>::quiet_NaN());
  }
  return tilts_rad_;
}

}  // namespace odoless
