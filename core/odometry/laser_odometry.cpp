#include "core/odometry/laser_odometry.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "core/base/scan_span.hpp"

namespace odoless {
namespace {

constexpr double kMatch_sd_m = 0.01;  // what no covariance of a match may undercut: cells, thinning, distortion
constexpr double kMatch_sd_rad = 0.003;
constexpr double kHole_s = 1.0;  // between two scans: who sees little again after it may have gone there by itself
constexpr double kSpeed_kept_unmatched = 0.5;

// The covariance in axes that the old ones are turned against by yaw_rad.
Eigen::Matrix3d turned(const Eigen::Matrix3d& covariance, double yaw_rad) {
  const double c = std::cos(yaw_rad);
  const double s = std::sin(yaw_rad);
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  turn.topLeftCorner<2, 2>() << c, -s, s, c;
  return turn * covariance * turn.transpose();
}

}  // namespace

LaserOdometry::LaserOdometry(const LaserOdometryParams& params, const MatcherParams& matcher, const ScanParams& scan)
    : params_(params),
      matcher_(matcher),
      reference_(params.local_map, matcher.points_max * params.key_scans),
      keys_(static_cast<std::size_t>(params.key_scans), KeyScan{ScanFrame(scan), {}}),
      placed_(static_cast<std::size_t>(params.key_scans)) {
  ODOLESS_CHECK(parameters_in_range(params));
  covariance_.bottomRightCorner<2, 2>().diagonal().setConstant(0.5 * params.speed_error_max_mps *
                                                               params.speed_error_max_mps);
}

OdometryStep LaserOdometry::process(const ScanFrame& scan, const Deadline& deadline, Rng& rng) {
  if (rebuild_is_due_) {
    rebuild_reference();
  }
  OdometryStep step;
  step.to_stamp_ns = scan.stamp_ns();
  step.from_stamp_ns = started_ ? stamp_ns_ : step.to_stamp_ns;
  const double period_s = steady_period_s(
      std::max(params_.period_min_s, static_cast<double>(step.to_stamp_ns - step.from_stamp_ns) * 1e-9));
  const Prediction prediction = predict(period_s);
  const Pose2 odom_T_key = reference_.empty() ? odom_T_scan_ : odom_T_key_;
  const Pose2 key_T_scan = odom_T_key.inverse() * prediction.odom_T_scan;
  const Deviations expected = deviations(period_s);
  const double widening = params_.expectation_widening;
  const Result<MatchResult> match = matcher_.match(
      reference_, scan, {key_T_scan, widening * expected.sd_m, widening * expected.sd_rad}, deadline, rng);
  step.matched = match.ok();
  step.match = match.ok() ? match.value() : MatchResult{};
  const bool is_hole = period_s > kHole_s;
  step.jolted = step.matched && !is_hole && step.match.score < params_.jolt_share * usual_score_.value();
  step.odom_T_scan = prediction.odom_T_scan;
  step.error = started_ ? prediction.error : MotionError{};  // the first scan is where the run begins
  if (step.matched) {
    correct(prediction, odom_T_key, step);
  }
  step.previous_T_current = odom_T_scan_.inverse() * step.odom_T_scan;
  step.covariance = increment_covariance(prediction, step);
  remember(step, period_s);
  if (is_over_a_jolt(step, period_s)) {
    key_count_ = 0;
    add_key(scan, odom_T_scan_);
  } else if (reference_.empty() || (odom_T_key.inverse() * odom_T_scan_).distance_m({}) > params_.key_distance_m ||
             std::abs(wrap_angle(odom_T_scan_.yaw_rad - odom_T_key.yaw_rad)) > params_.key_rotation_rad) {
    add_key(scan, odom_T_scan_);
  }
  return step;
}

bool LaserOdometry::is_over_a_jolt(const OdometryStep& step, double period_s) {
  if (step.matched) {
    usual_score_.add(step.match.score, std::min(period_s, ScanSpan::kMax_s));
  }
  if (step.jolted) {
    jolt_scans_left_ = params_.jolt_scans;
  }
  return !step.jolted && jolt_scans_left_ > 0 && --jolt_scans_left_ == 0;
}

// Of the motion alone, whatever the pose before was off by: what the error gained or lost.
Eigen::Matrix3d LaserOdometry::increment_covariance(const Prediction& prediction, const OdometryStep& step) const {
  Eigen::Matrix<double, 3, 5> gained = step.error.carried.topRows<3>();
  gained.leftCols<3>() -= prediction.error.carried.topLeftCorner<3, 3>();
  const Eigen::Matrix3d covariance = gained * covariance_ * gained.transpose() + step.error.noise.topLeftCorner<3, 3>();
  return turned(covariance, step.previous_T_current.yaw_rad);
}

// Devices scan steadily; stamps that waver about the usual period say more of the computer than of the laser.
double LaserOdometry::steady_period_s(double period_s) {
  constexpr double kWaver_min = 0.4;
  constexpr double kWaver_max = 1.7;  // less than 2: a scan that is missing is no wavering
  constexpr double kGain = 0.1;
  const bool wavers = period_s > kWaver_min * usual_period_s_ && period_s < kWaver_max * usual_period_s_;
  usual_period_s_ = wavers ? usual_period_s_ + kGain * (period_s - usual_period_s_) : period_s;
  return wavers ? usual_period_s_ : period_s;
}

void LaserOdometry::remember(const OdometryStep& step, double period_s) {
  // A blind robot is not taken to drive on for ever, and one that was carried away not to go on like that.
  const bool is_fast = step.previous_T_current.distance_m({}) > params_.leap_mps * period_s ||
                       std::abs(step.previous_T_current.yaw_rad) > params_.leap_radps * period_s;
  const bool leapt = step.matched && (step.jolted || (step.match.escalated && is_fast));
  const double kept = leapt ? 0.0 : step.matched ? 1.0 : kSpeed_kept_unmatched;
  speed_x_mps_ *= kept;
  speed_y_mps_ *= kept;
  speed_yaw_radps_ = kept * step.previous_T_current.yaw_rad / period_s;
  if (started_) {
    covariance_ = step.error.carried * covariance_ * step.error.carried.transpose() + step.error.noise;
  }
  odom_T_scan_ = step.odom_T_scan;
  stamp_ns_ = step.to_stamp_ns;
  started_ = true;
}

LaserOdometry::Prediction LaserOdometry::predict(double period_s) const {
  const double driven_s = std::min(period_s, params_.prediction_max_s);
  const Pose2 motion{speed_x_mps_ * driven_s, speed_y_mps_ * driven_s, speed_yaw_radps_ * driven_s};
  const double c = std::cos(motion.yaw_rad);
  const double s = std::sin(motion.yaw_rad);
  Eigen::Matrix2d turn;  // into the new scan's axes
  turn << c, s, -s, c;
  Prediction out;
  out.odom_T_scan = odom_T_scan_ * motion;
  MotionError::Matrix& carried = out.error.carried;
  carried.topLeftCorner<2, 2>() = turn;
  carried.block<2, 1>(0, 2) = turn * Eigen::Vector2d(-motion.y_m, motion.x_m);
  carried.topRightCorner<2, 2>() = driven_s * turn;
  const double walk = params_.speed_walk_sd_mps * params_.speed_walk_sd_mps;
  MotionError::Matrix& noise = out.error.noise;
  noise.topLeftCorner<2, 2>().diagonal().setConstant(walk * period_s * period_s * period_s / 3.0);
  noise.topRightCorner<2, 2>() = 0.5 * walk * period_s * period_s * turn;
  noise.bottomLeftCorner<2, 2>() = noise.topRightCorner<2, 2>().transpose();
  noise.bottomRightCorner<2, 2>().diagonal().setConstant(walk * period_s);
  const double sd_rad = deviations(period_s).sd_rad;
  noise(2, 2) = sd_rad * sd_rad;
  const MotionError::Matrix ahead = carried * covariance_ * carried.transpose() + noise;
  const double variance = ahead.bottomRightCorner<2, 2>().trace();
  const double kept = std::min(1.0, params_.speed_error_max_mps / std::sqrt(std::max(1e-12, variance)));
  MotionError::Matrix bound = MotionError::Matrix::Identity();
  bound.bottomRightCorner<2, 2>() *= kept;
  return {out.odom_T_scan, {bound * carried, bound * noise * bound}};
}

LaserOdometry::Deviations LaserOdometry::deviations(double period_s) const {
  // At a high rate the speed itself is uncertain: a match's error is divided by a short period. An expectation that
  // shrinks with the square of the period would then hold the estimate back where the robot starts or turns.
  // Stamps that are the same or run backwards say nothing of that.
  const double span_s =
      period_s > params_.period_min_s ? std::max(period_s, params_.expectation_period_min_s) : period_s;
  return {params_.acceleration_sd_mps2 * span_s * span_s, params_.angular_acceleration_sd_radps2 * span_s * span_s};
}

void LaserOdometry::correct(const Prediction& prediction, const Pose2& odom_T_key, OdometryStep& step) {
  const Pose2 key_T_scan = odom_T_key.inverse() * prediction.odom_T_scan;
  const Pose2 difference = key_T_scan.inverse() * step.match.reference_T_scan;
  Eigen::Matrix3d match = turned(step.match.covariance, -key_T_scan.yaw_rad);
  match.diagonal() +=
      Eigen::Vector3d(kMatch_sd_m * kMatch_sd_m, kMatch_sd_m * kMatch_sd_m, kMatch_sd_rad * kMatch_sd_rad);
  const MotionError& ahead = prediction.error;
  const MotionError::Matrix prior = ahead.carried * covariance_ * ahead.carried.transpose() + ahead.noise;
  const Eigen::Matrix<double, 5, 3> gain =
      (prior.topLeftCorner<3, 3>() + match).ldlt().solve(prior.topRows<3>()).transpose();
  MotionError::Matrix rest = MotionError::Matrix::Identity();
  rest.leftCols<3>() -= gain;
  const MotionError::Vector moved = gain * Eigen::Vector3d(difference.x_m, difference.y_m, difference.yaw_rad);
  step.odom_T_scan = prediction.odom_T_scan * Pose2{moved(0), moved(1), moved(2)};
  speed_x_mps_ += moved(3);
  speed_y_mps_ += moved(4);
  step.error.carried = rest * ahead.carried;
  step.error.noise = rest * ahead.noise * rest.transpose() + gain * match * gain.transpose();  // Joseph: never negative
}

void LaserOdometry::add_key(const ScanFrame& scan, const Pose2& odom_T_scan) {
  const int capacity = params_.key_scans;
  newest_key_ = (newest_key_ + 1) % capacity;
  key_count_ = std::min(key_count_ + 1, capacity);
  KeyScan& newest = keys_[static_cast<std::size_t>(newest_key_)];
  newest.scan = scan;  // each by itself: a KeyScan in between would allocate
  newest.odom_T_scan = odom_T_scan;
  odom_T_key_ = odom_T_scan;
  rebuild_is_due_ = true;
}

void LaserOdometry::rebuild_reference() {
  const int capacity = params_.key_scans;
  const Pose2 key_T_odom = odom_T_key_.inverse();
  for (int age = 0; age < key_count_; ++age) {  // newest first
    const KeyScan& key = keys_[static_cast<std::size_t>((newest_key_ - age + capacity) % capacity)];
    placed_[static_cast<std::size_t>(age)] = {&key.scan, key_T_odom * key.odom_T_scan};
  }
  static_cast<void>(reference_.rebuild({placed_.data(), static_cast<std::size_t>(key_count_)}));
  rebuild_is_due_ = false;
}

}  // namespace odoless
