#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <span>

#include "core/base/check.hpp"
#include "firmware/lcm/decode.hpp"

namespace odoless::test {

inline void check_pose(const Pose2& pose) {
  ODOLESS_CHECK(std::isfinite(pose.x_m) && std::isfinite(pose.y_m) && std::isfinite(pose.yaw_rad));
}

inline void check_scan(const RawScan& scan) {
  ODOLESS_CHECK(scan.stamp_ns >= 0 && scan.stamp_ns % 1000 == 0);
  ODOLESS_CHECK(std::isfinite(scan.start_angle_rad) && std::isnormal(scan.angle_step_rad));
  for (const float range_m : scan.ranges_m) {
    ODOLESS_CHECK(range_m == 0.0F || std::isnormal(range_m) || std::isinf(range_m));
    ODOLESS_CHECK(range_m >= 0.0F);
  }
}

inline void check_covariance(const MatrixRows<3>& covariance) {
  for (const double entry : covariance) {
    ODOLESS_CHECK(entry == 0.0 || std::isnormal(entry));
  }
  ODOLESS_CHECK(covariance[0] >= 0.0 && covariance[4] >= 0.0 && covariance[8] >= 0.0);
}

inline void check_motion(const Motion& motion) {
  ODOLESS_CHECK(motion.from_stamp_ns >= 0 && motion.from_stamp_ns <= motion.to_stamp_ns);
  check_pose(motion.odom_T_current);
  check_pose(motion.previous_T_current);
  ODOLESS_CHECK(motion.covariance().allFinite());
  ODOLESS_CHECK(motion.duration_ns >= 0 && motion.duration_sd_s >= 0.0 && std::isfinite(motion.duration_sd_s));
  ODOLESS_CHECK(motion.fitness >= 0.0 && motion.second_peak_ratio >= 0.0 && std::isfinite(motion.score));
  ODOLESS_CHECK(motion.evaluations >= 0 && motion.steps > 0 && motion.alternative_count >= 0);
  ODOLESS_CHECK(static_cast<std::size_t>(motion.alternative_count) <= Motion::kAlternativesMax);
  for (const MotionHypothesis& other : motion.others()) {
    check_pose(other.previous_T_current);
    check_covariance(other.covariance);
    ODOLESS_CHECK(std::isfinite(other.log_weight));
  }
  check_pose(motion.then(motion).previous_T_current);
}

/// Gives any bytes to all decoders and breaks off if one accepts what is not sane. The error, kOk if one accepts.
inline Errc decode_any(std::span<const std::byte> message) {
  std::array<float, 64> room;
  const Result<RawScan> scan = decode_scan(message, room);
  if (scan.ok()) {
    check_scan(scan.value());
    return Errc::kOk;
  }
  const Result<Motion> motion = decode_motion(message);
  if (motion.ok()) {
    check_motion(motion.value());
    return Errc::kOk;
  }
  const Result<ScanTimes> times = decode_scan_times(message);
  if (times.ok()) {
    ODOLESS_CHECK(std::abs(times.value().first_beam_ns) <= 1'000'000'000);
    ODOLESS_CHECK(std::abs(times.value().beam_period_ns) <= 1'000'000'000);
    return Errc::kOk;
  }
  const Errc of_others = motion.error() == Errc::kUnknownType ? times.error() : motion.error();
  return scan.error() == Errc::kUnknownType ? of_others : scan.error();
}

}  // namespace odoless::test
