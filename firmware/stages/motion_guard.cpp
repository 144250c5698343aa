#include "firmware/stages/motion_guard.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "core/math/elementary.hpp"

namespace odoless {
namespace {

constexpr double kGenerosity = 3.0;    // what a person knows of a robot's limits is no measurement
constexpr double kStepSlack_m = 1.0;   // a match is off by less
constexpr double kOtherSlack_m = 5.0;  // other answers of a match may be anywhere that its second search looks
constexpr double kSpreadSlack_m = 10.0;
constexpr double kDurationSlack_s = 0.1;  // of an estimate against the stamps
constexpr double kGainMax = 1000.0;  // of an error over a motion, per second and at least: a speed's follows a jump

double seconds(std::int64_t duration_ns) { return static_cast<double>(duration_ns) * 1e-9; }

// Of the motion by its stamps, and by its own estimate as far as those allow it.
double time_of(const Motion& motion) {
  const double by_stamps_s = seconds(motion.to_stamp_ns - motion.from_stamp_ns);
  return std::max(by_stamps_s, std::min(motion.duration_s(), by_stamps_s + kDurationSlack_s));
}

// As correlations, for metres and radians differ by much. What rounding does to a product of matrices is let through.
template <std::size_t kSize, class Rows>
bool is_covariance(const Rows& rows) {
  constexpr double kRounding = 1e-6;
  constexpr double kNothing = 1e-9;
  using Matrix = Eigen::Matrix<double, static_cast<int>(kSize), static_cast<int>(kSize)>;
  Matrix correlation = Matrix::Identity() * (1.0 + kRounding);
  for (std::size_t i = 0; i < kSize; ++i) {
    const double variance = rows[i * kSize + i];
    if (!(variance >= 0.0)) {  // nor if it is no number
      return false;
    }
    for (std::size_t j = 0; j < i; ++j) {
      const double below = rows[i * kSize + j];
      const double scale = std::sqrt(variance * rows[j * kSize + j]) + kNothing;
      if (std::abs(below - rows[j * kSize + i]) > kRounding * (scale + kNothing)) {
        return false;
      }
      correlation(static_cast<int>(i), static_cast<int>(j)) = below / scale;
    }
  }
  return correlation.llt().info() == Eigen::Success;  // of the lower triangle
}

// The largest variance along x or y, row by row.
template <class Rows>
double variance_m2(const Rows& rows, std::size_t size) {
  return std::max(rows[0], rows[size + 1]);
}

}  // namespace

bool MotionGuard::is_within_reach(const Pose2& way, double time_s, double slack_m) const {
  constexpr double kTurnSlack_rad = 1.0;
  const double turn_max_rad = kTurnSlack_rad + kGenerosity * limits_.turn_rate_max_radps * time_s;
  return math::hypot(way.x_m, way.y_m) <= slack_m + kGenerosity * limits_.speed_max_mps * time_s &&
         (turn_max_rad >= std::numbers::pi || std::abs(wrap_angle(way.yaw_rad)) <= turn_max_rad);
}

bool MotionGuard::is_possible(const Motion& motion) const {
  const double time_s = time_of(motion);
  const double spread_max_m =
      kSpreadSlack_m + (limits_.acceleration_max_mps2 * time_s + 2.0 * kGenerosity * limits_.speed_max_mps) * time_s;
  const auto is_certain_enough = [spread_max_m](const auto& rows, std::size_t size) {
    return variance_m2(rows, size) <= spread_max_m * spread_max_m;
  };
  return is_within_reach(motion.previous_T_current, time_s, kStepSlack_m) && is_covariance<5>(motion.error_initial) &&
         is_covariance<5>(motion.error_noise) && is_certain_enough(motion.error_noise, 5) &&
         is_covariance<2>(motion.map_slip) && is_certain_enough(motion.map_slip, 2) &&
         std::all_of(motion.error_transition.begin(), motion.error_transition.end(),
                     [time_s](double gain) { return std::abs(gain) <= kGainMax * (1.0 + time_s); }) &&
         std::all_of(motion.others().begin(), motion.others().end(), [&](const MotionHypothesis& other) {
           return math::hypot(other.previous_T_current.x_m, other.previous_T_current.y_m) <=
                      kOtherSlack_m + kGenerosity * limits_.speed_max_mps * time_s &&
                  is_covariance<3>(other.covariance) && is_certain_enough(other.covariance, 3);
         });
}

bool MotionGuard::follows(const Place& last, const Motion& motion, std::int64_t now_ns) const {
  const double ahead_s = seconds(motion.to_stamp_ns - last.to_stamp_ns);
  const double ahead_max_s = seconds(kAhead_ns) + kPaceMax * seconds(now_ns - last.arrival_ns);
  const double time_s = ahead_s + kDurationSlack_s;
  const Pose2 way = last.odom_T_current.inverse() * motion.odom_T_current;
  return ahead_s > 0.0 && ahead_s <= ahead_max_s && is_within_reach(way, time_s, kStepSlack_m) &&
         is_within_reach(motion.previous_T_current, std::min(time_of(motion), time_s), kStepSlack_m);
}

bool MotionGuard::begins_anew(const Motion& motion, std::int64_t now_ns) {
  others_in_a_row_ = others_in_a_row_ > 0 && follows(other_, motion, now_ns) ? others_in_a_row_ + 1 : 1;
  other_ = {motion.to_stamp_ns, now_ns, motion.odom_T_current};
  return others_in_a_row_ >= kAnewMotions;
}

MotionVerdict MotionGuard::accept(const Motion& motion, std::int64_t now_ns, MotionVerdict verdict) {
  arrived_after_ns_ = has_last_ ? now_ns - last_.arrival_ns : 0;
  last_ = {motion.to_stamp_ns, now_ns, motion.odom_T_current};
  has_last_ = true;
  others_in_a_row_ = 0;
  return verdict;
}

MotionVerdict MotionGuard::judge(const Motion& motion, std::int64_t now_ns) {
  if (!is_possible(motion)) {
    ++refused_;
    return MotionVerdict::kRefused;
  }
  if (!has_last_) {
    return accept(motion, now_ns, MotionVerdict::kBegins);
  }
  if (follows(last_, motion, now_ns)) {
    return accept(motion, now_ns, MotionVerdict::kFollows);
  }
  if (begins_anew(motion, now_ns)) {
    const Pose2 way = last_.odom_T_current.inverse() * motion.odom_T_current;
    const bool is_same_odometry = is_within_reach(way, seconds(now_ns - last_.arrival_ns), kStepSlack_m);
    return accept(motion, now_ns, is_same_odometry ? MotionVerdict::kContinues : MotionVerdict::kBegins);
  }
  if (motion.to_stamp_ns <= last_.to_stamp_ns && motion.to_stamp_ns > last_.to_stamp_ns - kBehind_ns) {
    return MotionVerdict::kOld;
  }
  ++refused_;
  return MotionVerdict::kRefused;
}

}  // namespace odoless
