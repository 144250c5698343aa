#include "core/odometry/laser_odometry.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace odoless {
namespace {

constexpr double kMatch_sd_m = 0.01;  // what no covariance of a match may undercut: cells, thinning, distortion
constexpr double kMatch_sd_rad = 0.003;
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
}

OdometryStep LaserOdometry::process(const ScanFrame& scan, const Deadline& deadline, Rng& rng) {
  OdometryStep step;
  step.to_stamp_ns = scan.stamp_ns();
  step.from_stamp_ns = started_ ? stamp_ns_ : step.to_stamp_ns;
  const double period_s =
      std::max(params_.period_min_s, static_cast<double>(step.to_stamp_ns - step.from_stamp_ns) * 1e-9);
  const Pose2 odom_T_key = reference_.empty() ? odom_T_scan_ : odom_T_key_;
  const Pose2 key_T_scan = odom_T_key.inverse() * predict(period_s);
  const Deviations expected = deviations(period_s);
  const double widening = params_.expectation_widening;
  const Result<MatchResult> match = matcher_.match(
      reference_, scan, {key_T_scan, widening * expected.sd_m, widening * expected.sd_rad}, deadline, rng);
  step.matched = match.ok();
  step.match = match.ok() ? match.value() : MatchResult{};
  const Fused fused = match.ok() ? fuse(key_T_scan, step.match, expected) : Fused{key_T_scan, expected.covariance()};
  step.odom_T_scan = odom_T_key * fused.key_T_scan;
  step.previous_T_current = odom_T_scan_.inverse() * step.odom_T_scan;
  step.covariance = turned(fused.covariance, (odom_T_scan_.inverse() * odom_T_key).yaw_rad);
  remember(step, period_s);
  if (reference_.empty() || std::hypot(fused.key_T_scan.x_m, fused.key_T_scan.y_m) > params_.key_distance_m ||
      std::abs(fused.key_T_scan.yaw_rad) > params_.key_rotation_rad) {
    add_key(scan, odom_T_scan_);
  }
  return step;
}

void LaserOdometry::remember(const OdometryStep& step, double period_s) {
  const double kept = step.matched ? 1.0 : kSpeed_kept_unmatched;  // a blind robot is not taken to drive on for ever
  speed_x_mps_ = kept * step.previous_T_current.x_m / period_s;
  speed_y_mps_ = kept * step.previous_T_current.y_m / period_s;
  speed_yaw_radps_ = kept * step.previous_T_current.yaw_rad / period_s;
  odom_T_scan_ = step.odom_T_scan;
  stamp_ns_ = step.to_stamp_ns;
  started_ = true;
}

Pose2 LaserOdometry::predict(double period_s) const {
  const double driven_s = std::min(period_s, params_.prediction_max_s);
  return odom_T_scan_ * Pose2{speed_x_mps_ * driven_s, speed_y_mps_ * driven_s, speed_yaw_radps_ * driven_s};
}

LaserOdometry::Deviations LaserOdometry::deviations(double period_s) const {
  // At a high rate the speed itself is uncertain: a match's error is divided by a short period. An expectation that
  // shrinks with the square of the period would then hold the estimate back where the robot starts or turns.
  // Stamps that are the same or run backwards say nothing of that.
  const double span_s =
      period_s > params_.period_min_s ? std::max(period_s, params_.expectation_period_min_s) : period_s;
  return {params_.acceleration_sd_mps2 * span_s * span_s, params_.angular_acceleration_sd_radps2 * span_s * span_s};
}

Eigen::Matrix3d LaserOdometry::Deviations::covariance() const {
  return Eigen::Vector3d(sd_m * sd_m, sd_m * sd_m, sd_rad * sd_rad).asDiagonal();
}

LaserOdometry::Fused LaserOdometry::fuse(const Pose2& prediction, const MatchResult& match,
                                         const Deviations& expected) {
  Eigen::Matrix3d match_covariance = match.covariance;
  match_covariance.diagonal() +=
      Eigen::Vector3d(kMatch_sd_m * kMatch_sd_m, kMatch_sd_m * kMatch_sd_m, kMatch_sd_rad * kMatch_sd_rad);
  if (expected.sd_m <= 0.0 || expected.sd_rad <= 0.0) {
    return {match.reference_T_scan, match_covariance};
  }
  const Eigen::Matrix3d prior = expected.covariance();
  const Eigen::Matrix3d gain = (prior + match_covariance).ldlt().solve(prior).transpose();
  const Eigen::Matrix3d rest = Eigen::Matrix3d::Identity() - gain;
  const Eigen::Vector3d difference(match.reference_T_scan.x_m - prediction.x_m,
                                   match.reference_T_scan.y_m - prediction.y_m,
                                   wrap_angle(match.reference_T_scan.yaw_rad - prediction.yaw_rad));
  const Eigen::Vector3d moved = gain * difference;
  return {{prediction.x_m + moved.x(), prediction.y_m + moved.y(), wrap_angle(prediction.yaw_rad + moved.z())},
          rest * prior * rest.transpose() + gain * match_covariance * gain.transpose()};  // Joseph: never negative
}

void LaserOdometry::add_key(const ScanFrame& scan, const Pose2& odom_T_scan) {
  const int capacity = params_.key_scans;
  newest_key_ = (newest_key_ + 1) % capacity;
  key_count_ = std::min(key_count_ + 1, capacity);
  KeyScan& newest = keys_[static_cast<std::size_t>(newest_key_)];
  newest.scan = scan;  // each by itself: a KeyScan in between would allocate
  newest.odom_T_scan = odom_T_scan;
  odom_T_key_ = odom_T_scan;
  const Pose2 key_T_odom = odom_T_scan.inverse();
  for (int age = 0; age < key_count_; ++age) {  // newest first
    const KeyScan& key = keys_[static_cast<std::size_t>((newest_key_ - age + capacity) % capacity)];
    placed_[static_cast<std::size_t>(age)] = {&key.scan, key_T_odom * key.odom_T_scan};
  }
  static_cast<void>(reference_.rebuild({placed_.data(), static_cast<std::size_t>(key_count_)}));
}

}  // namespace odoless
