#include "firmware/lcm/decode.hpp"

#include <algorithm>
#include <bot_core/planar_lidar_t.hpp>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <odoless/motion_t.hpp>
#include <odoless/scan_times_t.hpp>

#include "firmware/lcm/wire_reader.hpp"

namespace odoless {
namespace {

constexpr double kDistanceMaxM = 1e6;
constexpr std::int64_t kDurationMaxNs = 1'000'000'000'000'000'000;  // 30 years
constexpr std::int64_t kBeamTimeMaxNs = 1'000'000'000;
constexpr double kLogWeightMax = 1e6;
constexpr double kAngleMaxRad = 4.0 * std::numbers::pi;
constexpr double kSweepMaxRad =
    2.0 * std::numbers::pi * 1.001;  // a full turn, and the rounding of a single-precision step
constexpr std::int64_t kUtimeMax = std::numeric_limits<std::int64_t>::max() / 1000;

// Denormal numbers are no measurement, and slow to work with.
bool is_sane(double value) { return value == 0.0 || std::isnormal(value); }
bool is_sane_float(float value) { return value == 0.0F || std::isnormal(value); }
bool is_sane_distance(double value_m) { return is_sane(value_m) && std::abs(value_m) <= kDistanceMaxM; }
bool is_sane_angle(double value_rad) { return is_sane(value_rad) && std::abs(value_rad) <= kAngleMaxRad; }
bool is_sane_utime(std::int64_t utime) { return utime >= 0 && utime <= kUtimeMax; }
bool is_sane_share(double value) { return is_sane(value) && value >= 0.0; }

bool is_sane_log_weight(double value) { return is_sane(value) && std::abs(value) <= kLogWeightMax; }

bool is_sane_pose(const Pose2& pose) {
  return is_sane_distance(pose.x_m) && is_sane_distance(pose.y_m) && is_sane_angle(pose.yaw_rad);
}

bool is_sane_covariance(const MatrixRows<3>& covariance) {
  return std::all_of(covariance.begin(), covariance.end(), is_sane) && covariance[0] >= 0.0 && covariance[4] >= 0.0 &&
         covariance[8] >= 0.0;
}

float sane_range_m(float range_m) {
  const bool known = range_m > 0.0F && (std::isinf(range_m) || std::isnormal(range_m));
  return known ? range_m : 0.0F;
}

bool is_sane_geometry(float start_angle_rad, float angle_step_rad, std::int32_t beams) {
  return is_sane_float(start_angle_rad) && is_sane_angle(start_angle_rad) && std::isnormal(angle_step_rad) &&
         std::abs(static_cast<double>(angle_step_rad)) * std::max(0, beams - 1) <= kSweepMaxRad;
}

// Products of small numbers may well be denormal here.
template <std::size_t kCount>
bool is_sane_matrix(const std::array<double, kCount>& matrix, double max) {
  return std::all_of(matrix.begin(), matrix.end(), [max](double value) { return std::abs(value) <= max; });
}

bool is_sane_error(const Motion& motion) {
  constexpr double kMax = 1e6;
  constexpr double kInitialMax = 1e12;  // a laser that is blind for an hour may be anywhere
  bool is_sane = is_sane_matrix(motion.error_initial, kInitialMax) && is_sane_matrix(motion.error_transition, kMax) &&
                 is_sane_matrix(motion.error_noise, kMax) && is_sane_matrix(motion.map_slip, kMax);
  for (std::size_t i = 0; i < motion.error_noise.size(); i += ErrorProcess::kSize + 1) {
    is_sane = is_sane && motion.error_initial[i] >= 0.0 && motion.error_noise[i] >= 0.0;
  }
  return is_sane;
}

bool is_sane_hypothesis(const MotionHypothesis& hypothesis) {
  return is_sane_pose(hypothesis.previous_T_current) && is_sane_log_weight(hypothesis.log_weight) &&
         is_sane_covariance(hypothesis.covariance);
}

Pose2 read_pose(WireReader& reader) {
  const double x_m = reader.real64();
  const double y_m = reader.real64();
  return {x_m, y_m, reader.real64()};
}

MotionHypothesis read_hypothesis(WireReader& reader) {
  MotionHypothesis hypothesis;
  hypothesis.previous_T_current = read_pose(reader);
  hypothesis.log_weight = reader.real64();
  reader.reals(hypothesis.covariance);
  return hypothesis;
}

/// All that stands between the stamps and the alternatives.
void read_motion(WireReader& reader, Motion& motion) {
  motion.duration_ns = reader.int64();
  motion.duration_sd_s = reader.real64();
  motion.previous_T_current = read_pose(reader);
  motion.odom_T_current = read_pose(reader);
  MatrixRows<3> covariance{};
  reader.reals(covariance);
  reader.reals(motion.error_initial);
  reader.reals(motion.error_transition);
  reader.reals(motion.error_noise);
  motion.set_slip_of(matrix_of<3>(covariance));
  motion.fitness = reader.real64();
  motion.score = reader.real64();
  motion.second_peak_ratio = reader.real64();
  motion.strong_information_1_m2 = reader.real64();
  motion.weak_information_1_m2 = reader.real64();
  motion.evaluations = reader.int32();
  motion.steps = reader.int32();
  motion.flags = reader.unsigned_number<std::uint32_t>();
  motion.probability = reader.real64();
  motion.log_weight = reader.real64();
}

bool is_sane_motion(const Motion& motion) {
  return motion.from_stamp_ns <= motion.to_stamp_ns && motion.duration_ns >= 0 &&
         motion.duration_ns <= kDurationMaxNs && is_sane_share(motion.duration_sd_s) && motion.probability >= 0.0 &&
         motion.probability <= 1.0 && is_sane_pose(motion.previous_T_current) && is_sane_pose(motion.odom_T_current) &&
         is_sane_error(motion) && is_sane_share(motion.fitness) && is_sane(motion.score) &&
         is_sane_share(motion.second_peak_ratio) && is_sane(motion.strong_information_1_m2) &&
         is_sane(motion.weak_information_1_m2) && motion.evaluations >= 0 && motion.steps > 0 &&
         (motion.flags & ~kMotionFlags) == 0 && is_sane_log_weight(motion.log_weight) &&
         std::all_of(motion.others().begin(), motion.others().end(), is_sane_hypothesis);
}

}  // namespace

Result<RawScan> decode_scan(std::span<const std::byte> message, std::span<float> ranges_m) {
  WireReader reader(message);
  if (reader.int64() != bot_core::planar_lidar_t::getHash()) {
    return reader.ok() ? Errc::kUnknownType : Errc::kMalformed;
  }
  const std::int64_t utime = reader.int64();
  const std::int32_t beams = reader.int32();
  if (beams < 0) {
    return Errc::kMalformed;
  }
  if (static_cast<std::size_t>(beams) > ranges_m.size()) {
    return Errc::kTooLong;
  }
  const std::span<float> used_m = ranges_m.first(static_cast<std::size_t>(beams));
  std::generate(used_m.begin(), used_m.end(), [&reader] { return sane_range_m(reader.real32()); });
  const std::int32_t intensities = reader.int32();
  if (!reader.ok() || intensities < 0 || (intensities != 0 && intensities != beams)) {
    return Errc::kMalformed;
  }
  reader.skip(static_cast<std::size_t>(intensities) * sizeof(float));
  const float start_angle_rad = reader.real32();
  const float angle_step_rad = reader.real32();
  if (!reader.ok() || !reader.rest().empty()) {
    return Errc::kMalformed;
  }
  if (!is_sane_utime(utime) || !is_sane_geometry(start_angle_rad, angle_step_rad, beams)) {
    return Errc::kBadNumber;
  }
  return RawScan{.stamp_ns = utime * 1000,
                 .start_angle_rad = start_angle_rad,
                 .angle_step_rad = angle_step_rad,
                 .ranges_m = used_m};
}

Result<ScanTimes> decode_scan_times(std::span<const std::byte> message) {
  WireReader reader(message);
  if (reader.int64() != scan_times_t::getHash()) {
    return reader.ok() ? Errc::kUnknownType : Errc::kMalformed;
  }
  const std::int64_t utime = reader.int64();
  const ScanTimes times{.first_beam_ns = reader.int64(), .beam_period_ns = reader.int64()};
  if (!reader.ok() || !reader.rest().empty()) {
    return Errc::kMalformed;
  }
  const bool is_sane = std::clamp(times.first_beam_ns, -kBeamTimeMaxNs, kBeamTimeMaxNs) == times.first_beam_ns &&
                       std::clamp(times.beam_period_ns, -kBeamTimeMaxNs, kBeamTimeMaxNs) == times.beam_period_ns;
  if (!is_sane_utime(utime) || !is_sane) {
    return Errc::kBadNumber;
  }
  return times;
}

Result<Motion> decode_motion(std::span<const std::byte> message) {
  WireReader reader(message);
  if (reader.int64() != motion_t::getHash()) {
    return reader.ok() ? Errc::kUnknownType : Errc::kMalformed;
  }
  const std::int64_t utime = reader.int64();
  const std::int64_t reference_utime = reader.int64();
  Motion motion;
  read_motion(reader, motion);
  const std::int32_t alternatives = reader.int32();
  if (!reader.ok() || alternatives < 0) {
    return Errc::kMalformed;
  }
  if (static_cast<std::size_t>(alternatives) > Motion::kAlternativesMax) {
    return Errc::kTooLong;
  }
  motion.alternative_count = alternatives;
  const auto end = motion.alternatives.begin() + alternatives;
  std::generate(motion.alternatives.begin(), end, [&reader] { return read_hypothesis(reader); });
  if (!reader.ok() || !reader.rest().empty()) {
    return Errc::kMalformed;
  }
  if (!is_sane_utime(utime) || !is_sane_utime(reference_utime)) {
    return Errc::kBadNumber;
  }
  motion.to_stamp_ns = utime * 1000;
  motion.from_stamp_ns = reference_utime * 1000;
  return is_sane_motion(motion) ? Result<Motion>(motion) : Errc::kBadNumber;
}

}  // namespace odoless
