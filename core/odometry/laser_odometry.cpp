#include "core/odometry/laser_odometry.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace odoless {
namespace {

constexpr double kMatch_sd_m = 0.01;  // what no covariance of a match may undercut: cells, thinning, distortion
constexpr double kMatch_sd_rad = 0.003;

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
  step.from_stamp_ns = newest_key_ < 0 ? scan.stamp_ns() : stamp_ns_;
  step.to_stamp_ns = scan.stamp_ns();
  if (newest_key_ < 0) {
    add_key(scan, odom_T_scan_);
    stamp_ns_ = scan.stamp_ns();
    return step;
  }
  const double period_s = std::max(params_.period_min_s, static_cast<double>(scan.stamp_ns() - stamp_ns_) * 1e-9);
  const KeyScan& key = keys_[static_cast<std::size_t>(newest_key_)];
  const Pose2 key_T_odom = key.odom_T_scan.inverse();
  const Pose2 prediction = key_T_odom * predict(period_s);
  const double sd_m = params_.expectation_widening * params_.acceleration_sd_mps2 * period_s * period_s;
  const double sd_rad = params_.expectation_widening * params_.angular_acceleration_sd_radps2 * period_s * period_s;
  const Result<MatchResult> match = matcher_.match(reference_, scan, {prediction, sd_m, sd_rad}, deadline, rng);
  Pose2 key_T_scan = prediction;
  step.covariance = prior_covariance(period_s);
  if (match.ok()) {
    step.match = match.value();
    step.matched = true;
    Eigen::Matrix3d key_covariance;
    key_T_scan = fuse(prediction, step.match, period_s, key_covariance);
    const double yaw_rad = (key_T_odom * odom_T_scan_).yaw_rad;  // from the key's axes to the previous scan's
    Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
    turn.topLeftCorner<2, 2>() << std::cos(yaw_rad), std::sin(yaw_rad), -std::sin(yaw_rad), std::cos(yaw_rad);
    step.covariance = turn * key_covariance * turn.transpose();
  }
  step.odom_T_scan = key.odom_T_scan * key_T_scan;
  step.previous_T_current = odom_T_scan_.inverse() * step.odom_T_scan;
  speed_x_mps_ = step.previous_T_current.x_m / period_s;
  speed_y_mps_ = step.previous_T_current.y_m / period_s;
  speed_yaw_radps_ = step.previous_T_current.yaw_rad / period_s;
  odom_T_scan_ = step.odom_T_scan;
  stamp_ns_ = scan.stamp_ns();
  const bool is_away = std::hypot(key_T_scan.x_m, key_T_scan.y_m) > params_.key_distance_m ||
                       std::abs(key_T_scan.yaw_rad) > params_.key_rotation_rad;
  // A scan that was only predicted would push what was seen out of the local map; without a map any scan will do.
  if (step.matched ? is_away : reference_.empty()) {
    add_key(scan, odom_T_scan_);
  }
  return step;
}

Pose2 LaserOdometry::predict(double period_s) const {
  return odom_T_scan_ * Pose2{speed_x_mps_ * period_s, speed_y_mps_ * period_s, speed_yaw_radps_ * period_s};
}

Eigen::Matrix3d LaserOdometry::prior_covariance(double period_s) const {
  const double sd_m = params_.acceleration_sd_mps2 * period_s * period_s;
  const double sd_rad = params_.angular_acceleration_sd_radps2 * period_s * period_s;
  return Eigen::Vector3d(sd_m * sd_m, sd_m * sd_m, sd_rad * sd_rad).asDiagonal();
}

Pose2 LaserOdometry::fuse(const Pose2& prediction, const MatchResult& match, double period_s,
                          Eigen::Matrix3d& covariance) const {
  const Eigen::Matrix3d prior = prior_covariance(period_s);
  Eigen::Matrix3d match_covariance = match.covariance;
  match_covariance.diagonal() +=
      Eigen::Vector3d(kMatch_sd_m * kMatch_sd_m, kMatch_sd_m * kMatch_sd_m, kMatch_sd_rad * kMatch_sd_rad);
  if (prior(0, 0) <= 0.0 || prior(2, 2) <= 0.0) {
    covariance = match_covariance;
    return match.reference_T_scan;
  }
  const Eigen::Vector3d difference(match.reference_T_scan.x_m - prediction.x_m,
                                   match.reference_T_scan.y_m - prediction.y_m,
                                   wrap_angle(match.reference_T_scan.yaw_rad - prediction.yaw_rad));
  const Eigen::Matrix3d inverse_sum = (prior + match_covariance).inverse();
  const Eigen::Vector3d gain = prior * (inverse_sum * difference);
  covariance = prior - prior * inverse_sum * prior;
  return {prediction.x_m + gain.x(), prediction.y_m + gain.y(), wrap_angle(prediction.yaw_rad + gain.z())};
}

void LaserOdometry::add_key(const ScanFrame& scan, const Pose2& odom_T_scan) {
  const int capacity = params_.key_scans;
  newest_key_ = (newest_key_ + 1) % capacity;
  key_count_ = std::min(key_count_ + 1, capacity);
  KeyScan& newest = keys_[static_cast<std::size_t>(newest_key_)];
  newest.scan = scan;  // each by itself: a KeyScan in between would allocate
  newest.odom_T_scan = odom_T_scan;
  const Pose2 key_T_odom = odom_T_scan.inverse();
  for (int age = 0; age < key_count_; ++age) {  // newest first
    const KeyScan& key = keys_[static_cast<std::size_t>((newest_key_ - age + capacity) % capacity)];
    placed_[static_cast<std::size_t>(age)] = {&key.scan, key_T_odom * key.odom_T_scan};
  }
  static_cast<void>(reference_.rebuild({placed_.data(), static_cast<std::size_t>(key_count_)}));
}

}  // namespace odoless
