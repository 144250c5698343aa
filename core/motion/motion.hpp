#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>

#include "core/geometry/matrix_rows.hpp"
#include "core/geometry/pose2.hpp"
#include "core/geometry/velocity2.hpp"
#include "core/motion/error_process.hpp"

namespace odoless {

/// Bits of Motion::flags; odoless.motion_t has the same.
enum MotionFlag : std::uint32_t {
  kMatched = 1U << 0,      ///< not for the first scan, nor where nothing could be matched: then the prediction stands
  kConverged = 1U << 1,    ///< the match is no poor one
  kEscalated = 1U << 2,    ///< only the wide search was good enough, or none
  kDeadlineHit = 1U << 3,  ///< the search was cut short
  kJolted = 1U << 4,       ///< the scan matches the ones before much worse than is usual
  kRejected = 1U << 5,     ///< not even the wide search converged
  kMotionFlags = (1U << 6) - 1
};

/// One of several answers that a match allows.
struct MotionHypothesis {
  Pose2 previous_T_current{};
  double log_weight = 0.0;     ///< natural logarithm; only differences within one motion count
  MatrixRows<3> covariance{};  ///< of previous_T_current over (x_m, y_m, yaw_rad), previous scan's axes
};

/// The motion from one scan to a later one as laser odometry knows it: what goes from the matcher to the filter,
/// through queues, over LCM and to the outside. Default: no motion at all, which composes with any to that one.
///
/// Motions that follow each other compose: `then`. A stage that gets the sum knows what it would know of the parts.
///
/// Frames: previous_T_current takes coordinates in the current scan's frame to the previous one's.
/// Trivially copyable and without padding, so that it can go through rings as bytes.
struct Motion {
  static constexpr std::size_t kAlternativesMax = 4;

  std::int64_t from_stamp_ns = 0;  ///< as the scans have them
  std::int64_t to_stamp_ns = 0;
  std::int64_t duration_ns = 0;  ///< between the scans as estimated; may be less than 0 where stamps run backwards
  double duration_sd_s = 0.0;
  Pose2 previous_T_current{};
  Pose2 odom_T_current{};  ///< the sum of all motions since the run began; who missed some composes with it

  MatrixRows<5> error_initial{};  ///< ErrorProcess, which `error` gives
  MatrixRows<5> error_transition = identity_rows<5>();
  MatrixRows<5> error_noise{};

  /// What the local map has slipped by where only newer scans hold it, which no later match tells: covariance over
  /// (x_m, y_m), previous scan's axes. On top of `error`, which is against the local map. Multiples of 2^-40 m^2.
  MatrixRows<2> map_slip{};

  double fitness = 0.0;  ///< figures of the match: MatchResult's
  double score = 0.0;
  double second_peak_ratio = 0.0;  ///< the second best answer's score over the best one's; 0: none
  double strong_information_1_m2 = 0.0;
  double weak_information_1_m2 = 0.0;

  double probability = 1.0;  ///< that previous_T_current, or one of the alternatives, is right within 0.5 m and 5 deg
  double log_weight = 0.0;   ///< of previous_T_current against the alternatives
  std::array<MotionHypothesis, kAlternativesMax> alternatives{};  ///< other than previous_T_current, heaviest first

  std::int32_t alternative_count = 0;
  std::int32_t evaluations = 0;
  std::int32_t steps = 0;  ///< from scan to scan that it is made of; 0: no motion
  std::uint32_t flags = 0;

  /// A motion that is known, without doubt.
  [[nodiscard]] static Motion between(std::int64_t from_stamp_ns, std::int64_t to_stamp_ns,
                                      const Pose2& previous_T_current);

  [[nodiscard]] double duration_s() const { return static_cast<double>(duration_ns) * 1e-9; }
  /// Mean over the motion, in the current scan's axes; zero where nothing was matched.
  [[nodiscard]] Velocity2 velocity() const;
  [[nodiscard]] bool has(MotionFlag flag) const { return (flags & flag) != 0; }
  void set(MotionFlag flag, bool value) { flags = value ? flags | flag : flags & ~static_cast<std::uint32_t>(flag); }
  [[nodiscard]] bool matched() const { return has(kMatched); }

  [[nodiscard]] ErrorProcess error() const;
  void set_error(const ErrorProcess& error);
  /// Of previous_T_current over (x_m, y_m, yaw_rad), previous scan's axes; as `error` has it.
  [[nodiscard]] Eigen::Matrix3d covariance() const;
  /// With what the local map has slipped by, which comes out again bit for bit; none where `covariance` is >= 2048 m^2.
  [[nodiscard]] Eigen::Matrix3d covariance_with_slip() const;
  void set_slip_of(const Eigen::Matrix3d& covariance_with_slip);
  /// Rounded as map_slip is; none where it is no covariance.
  void set_map_slip(const Eigen::Matrix2d& slip);

  /// Share of previous_T_current in the weight of all hypotheses.
  [[nodiscard]] double weight() const;
  /// The hypothesis at a share, from 0 to 1, of the weight of all.
  [[nodiscard]] const Pose2& at_share(double share) const;

  [[nodiscard]] std::span<const MotionHypothesis> others() const {
    return std::span(alternatives).first(static_cast<std::size_t>(alternative_count));
  }

  /// This motion followed by the next one, which begins where this one ends.
  ///
  /// Poses, error processes, slips, durations (as independent ones), evaluations and steps add up. It is matched and
  /// converged if both are; escalated, cut short, jolted or rejected if one is. Of figures the worse one stands: the
  /// least fitness, score and information, the largest second peak. Probabilities multiply. Hypotheses: each of this
  /// with each of the next, weights multiplied. From the heaviest on, one within 0.1 m and 2 deg of a heavier one gives
  /// that its weight; four others at most are kept. Real time: no allocation.
  [[nodiscard]] Motion then(const Motion& next) const;
};

static_assert(std::is_trivially_copyable_v<Motion>);

}  // namespace odoless
