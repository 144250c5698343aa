#include "core/odometry/laser_odometry.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/scan_span.hpp"
#include "core/geometry/pose2_covariance.hpp"
#include "core/math/elementary.hpp"
#include "core/math/principal_axes.hpp"
#include "core/odometry/step_probability.hpp"

namespace odoless {
namespace {

constexpr double kMatch_sd_m = 0.01;  // what no covariance of a match may undercut: cells, thinning, distortion
constexpr double kMatch_sd_rad = 0.003;
constexpr double kHole_s = 1.0;       // between two scans: who sees little again after it may have gone there by itself
constexpr double kCredible = 0.9;     // a step that is less probable breaks the local map, and tells no speed
constexpr double kWeight_min = 0.05;  // of another answer that particles shall try
constexpr double kSlack_m = 0.1;      // of a step beyond the robot's limits: what the match may be off by
constexpr double kSlack_rad = 0.05;
constexpr double kReach_deviations = 3.0;
constexpr double kWide_m = 3.0;  // where the motion may lead farther, a search near the expected pose is not enough
constexpr double kSpeed_kept_unmatched = 0.5;
constexpr double kOpen_m = 0.3;      // standard deviation of a match that leaves a direction unconstrained
constexpr double kStray_s = 0.1;     // what stray points say of it is the same for so long, however many scans
constexpr double kSheared_m = 0.05;  // by the sweep's end: a match does not see less
constexpr double kSheared_rad = 0.02;
constexpr double kClearly_better = 1.05;  // score: less is chance
constexpr int kDeskewed_again = 2;
constexpr int kSlices_sure = 16;  // of a local map, however little time a match has left

void copy_figures(const MatchResult& match, Motion& motion) {
  motion.fitness = match.fitness;
  motion.score = match.score;
  motion.second_peak_ratio = match.second_peak_ratio();
  motion.strong_information_1_m2 = match.strong_information_1_m2;
  motion.weak_information_1_m2 = match.weak_information_1_m2;
  motion.evaluations = match.evaluations;
  motion.set(kConverged, match.converged);
  motion.set(kEscalated, match.escalated);
  motion.set(kRejected, match.escalated && !match.converged);
  motion.set(kDeadlineHit, match.stop == StopReason::kDeadline);
}

/// Of a match, with what it says of an unconstrained direction believed once in a time and not once in a scan.
Eigen::Matrix3d covariance_over(const Eigen::Matrix3d& covariance, double period_s) {
  const math::PrincipalAxes<2> axes = math::principal_axes<2>(covariance.topLeftCorner<2, 2>());
  const double open_m2 = std::max(0.0, axes.values(1) - kOpen_m * kOpen_m);
  const double more_scans = std::max(0.0, kStray_s / period_s - 1.0);
  Eigen::Matrix3d out = covariance;
  out.topLeftCorner<2, 2>() += more_scans * open_m2 * axes.axes.col(1) * axes.axes.col(1).transpose();
  return out;
}

/// What the laser has moved by in half of the sweep, as it was deskewed.
Pose2 to_middle(const ScanFrame& scan) {
  const double half_s = 0.5 * scan.deskewed_s();
  const Velocity2& speed = scan.deskewed_with();
  return {half_s * speed.x_mps, half_s * speed.y_mps, half_s * speed.yaw_radps};
}

/// Whether a scan that is deskewed with one of these speeds looks another than with the other.
bool shears(const Velocity2& one, const Velocity2& other, double sweep_s) {
  return sweep_s * math::hypot(one.x_mps - other.x_mps, one.y_mps - other.y_mps) > kSheared_m ||
         sweep_s * std::abs(one.yaw_radps - other.yaw_radps) > kSheared_rad;
}

}  // namespace

LaserOdometry::LaserOdometry(const LaserOdometryParams& params, const RobotLimits& limits, const MatcherParams& matcher,
                             const ScanParams& scan)
    : params_(params),
      limits_(limits),
      matcher_(matcher),
      map_{MatchReference(params.local_map, matcher.points_max * params.key_scans)},
      next_map_{MatchReference(params.local_map, matcher.points_max * params.key_scans)},
      keys_(static_cast<std::size_t>(params.key_scans), KeyScan{ScanFrame(scan), {}}),
      placed_(static_cast<std::size_t>(params.key_scans)) {
  ODOLESS_CHECK(parameters_in_range(params) && parameters_in_range(limits));
  forget_speed();
}

Motion LaserOdometry::process(ScanFrame& scan, const Deadline& deadline, Rng& rng) {
  const std::int64_t from_stamp_ns = started_ ? stamp_ns_ : scan.stamp_ns();
  Motion motion = Motion::between(from_stamp_ns, scan.stamp_ns(), {});
  motion.duration_ns = started_ ? scan.time_ns() - time_ns_ : 0;
  motion.duration_sd_s = started_ ? math::hypot(scan.time_sd_s(), time_sd_s_) : 0.0;
  const double period_s = std::max(params_.period_min_s, motion.duration_s());
  const Estimate prediction = predict(period_s);
  const Pose2 odom_T_key = map_.reference.empty() ? odom_T_scan_ : map_.odom_T_key;
  const Pose2 key_T_scan = odom_T_key.inverse() * prediction.odom_T_scan;
  const double unobserved_s = scan.unobserved_s() + period_s;
  MotionReach reach = expected_reach(unobserved_s);
  reach.distance_m += math::hypot(speed_x_mps_, speed_y_mps_) * motion.duration_sd_s;  // driven so much longer, or less
  reach.rotation_rad += std::abs(speed_yaw_radps_) * motion.duration_sd_s;
  const Expectation expected{key_T_scan, reach.distance_m, reach.rotation_rad, reach.distance_m > kWide_m,
                             odom_T_key.inverse() * odom_T_scan_};
  const Result<MatchResult> match = match_deskewed(scan, expected, period_s + motion.duration_sd_s, deadline, rng);
  copy_figures(match.ok() ? match.value() : MatchResult{}, motion);
  motion.set(kMatched, match.ok());
  motion.set(kJolted, match.ok() && unobserved_s < kHole_s && motion.score < params_.poor_share * usual_score_.value());
  // The first scan is where the run begins. A jolted scan's match tells more of the motion than the speed does if
  // accelerations allow it, and nothing else [core/slam/DECISIONS.md, D21].
  Estimate estimate{prediction.odom_T_scan, started_ ? prediction.error : ErrorProcess{}};
  if (match.ok() && (!motion.has(kJolted) ||
                     are_within(key_T_scan, match.value().reference_T_scan, reach.distance_m, reach.rotation_rad))) {
    estimate = corrected(prediction, odom_T_key, match.value(), period_s);
    motion.set_map_slip(turned(odom_slip(estimate, odom_T_key, match.value()), -odom_T_scan_.yaw_rad));
  }
  estimate.error.initial = covariance_;
  motion.odom_T_current = estimate.odom_T_scan;
  motion.previous_T_current = odom_T_scan_.inverse() * estimate.odom_T_scan;
  motion.set_error(estimate.error);
  judge(match, odom_T_key, unobserved_s, motion);
  remember(scan, motion, period_s);
  const Pose2 key_T_now = odom_T_key.inverse() * odom_T_scan_;
  if (begins_anew(motion)) {
    key_count_ = 0;
    map_.reference.clear();
    slip_.reset();
    add_key(scan, odom_T_scan_);
  } else if (!building_ && (map_.reference.empty() || key_T_now.distance_m({}) > params_.key_distance_m ||
                            std::abs(wrap_angle(key_T_now.yaw_rad)) > params_.key_rotation_rad)) {
    add_key(scan, odom_T_scan_);
  }
  build_map(deadline);
  return motion;
}

Result<MatchResult> LaserOdometry::match_deskewed(ScanFrame& scan, const Expectation& expected, double period_s,
                                                  const Deadline& deadline, Rng& rng) {
  scan.deskew(velocity());
  Result<MatchResult> best = matcher_.match(map_.reference, scan, expected, deadline, rng);
  for (int again = 0; again < kDeskewed_again && best.ok() && !deadline.expired(); ++again) {
    const Velocity2 taken = scan.deskewed_with();
    const Pose2 moved = between_middles(expected.rest_T_scan.inverse() * best.value().reference_T_scan, scan);
    const Velocity2 told{moved.x_m / period_s, moved.y_m / period_s, moved.yaw_rad / period_s};
    if (!shears(told, taken, scan.deskewed_s())) {
      break;
    }
    scan.deskew(told);
    const Result<MatchResult> other = matcher_.match(map_.reference, scan, expected, deadline, rng);
    if (!other.ok() || other.value().score < kClearly_better * best.value().score) {
      scan.deskew(taken);
      break;
    }
    best = other;
  }
  return best;
}

void LaserOdometry::judge(const Result<MatchResult>& match, const Pose2& odom_T_key, double period_s, Motion& motion) {
  if (!started_) {
    return;
  }
  const double usual = usual_score_.value();
  const double longest_s = period_s + motion.duration_sd_s;
  const bool is_within_limits =
      motion.previous_T_current.distance_m({}) <= limits_.speed_max_mps * longest_s + kSlack_m &&
      std::abs(motion.previous_T_current.yaw_rad) <= limits_.turn_rate_max_radps * longest_s + kSlack_rad;
  motion.probability =
      step_probability(limits_, {.period_s = period_s,
                                 .period_sd_s = motion.duration_sd_s,
                                 .matched = match.ok(),
                                 .is_within_limits = is_within_limits,
                                 .score_share = usual > 0.0 ? std::max(1e-9, motion.score / usual) : 0.0});
  if (!match.ok()) {
    return;
  }
  const std::span<const MatchPeak> peaks =
      std::span(match.value().peaks).first(static_cast<std::size_t>(match.value().peak_count));
  motion.log_weight = math::log(peaks[0].weight);
  for (const MatchPeak& peak : peaks.subspan(1)) {
    if (peak.weight >= kWeight_min) {
      motion.alternatives[static_cast<std::size_t>(motion.alternative_count++)] = {
          odom_T_scan_.inverse() * (odom_T_key * peak.reference_T_scan), math::log(peak.weight),
          rows_of<3>(motion.covariance())};
    }
  }
  usual_score_.add(motion.score, std::min(period_s, ScanSpan::kMax_s));
}

// What was mapped before may be elsewhere after an incredible step, or when several scans have matched it poorly.
bool LaserOdometry::begins_anew(const Motion& motion) {
  poor_in_a_row_ = motion.has(kJolted) ? poor_in_a_row_ + 1 : 0;
  const bool anew = motion.probability < kCredible || poor_in_a_row_ >= params_.poor_scans;
  if (anew) {
    poor_in_a_row_ = 0;
    usual_score_ = UsualLevel{kScore_memory_s};  // of another scene
  }
  return anew;
}

// A scan that was deskewed with another speed than the robot's is matched with the middle of its sweep where that
// belongs, and its stamp's pose is off by half a sweep of the difference. From stamp to stamp, that error of one scan
// would be the speed of the next, with the sign changed: where the sweep takes the whole period, it never ends. From
// middle to middle there is none.
Pose2 LaserOdometry::between_middles(const Pose2& step, const ScanFrame& scan) const {
  const Pose2 ahead = to_middle(scan);
  return {step.x_m + ahead.x_m - to_middle_.x_m, step.y_m + ahead.y_m - to_middle_.y_m,
          step.yaw_rad + ahead.yaw_rad - to_middle_.yaw_rad};
}

void LaserOdometry::remember(const ScanFrame& scan, const Motion& motion, double period_s) {
  // A blind robot is not taken to drive on for ever, and one that was carried away not to go on like that.
  const bool leapt = motion.matched() && motion.probability < kCredible;
  const double kept = leapt ? 0.0 : motion.matched() ? 1.0 : kSpeed_kept_unmatched;
  speed_x_mps_ *= kept;
  speed_y_mps_ *= kept;
  const Pose2& step = motion.previous_T_current;
  const bool is_by_match = started_ && motion.matched() && !motion.has(kJolted);
  const double turned_rad = is_by_match ? between_middles(step, scan).yaw_rad : step.yaw_rad;
  speed_yaw_radps_ = kept * turned_rad / (period_s + motion.duration_sd_s);
  to_middle_ = to_middle(scan);
  if (started_) {
    covariance_ = motion.error().after(covariance_);
    has_speed_ = has_speed_ || motion.matched();
  }
  if (leapt) {
    forget_speed();
  }
  odom_T_scan_ = motion.odom_T_current;
  stamp_ns_ = scan.stamp_ns();
  time_ns_ = scan.time_ns();
  time_sd_s_ = scan.time_sd_s();
  started_ = true;
}

void LaserOdometry::forget_speed() {
  covariance_.rightCols<2>().setZero();
  covariance_.bottomRows<2>().setZero();
  covariance_.bottomRightCorner<2, 2>().diagonal().setConstant(0.5 * params_.speed_error_max_mps *
                                                               params_.speed_error_max_mps);
}

LaserOdometry::Estimate LaserOdometry::predict(double period_s) const {
  const double driven_s = std::min(period_s, params_.prediction_max_s);
  const Pose2 motion{speed_x_mps_ * driven_s, speed_y_mps_ * driven_s, speed_yaw_radps_ * driven_s};
  const auto [s, c] = math::sincos(motion.yaw_rad);
  Eigen::Matrix2d turn;  // into the new scan's axes
  turn << c, s, -s, c;
  Estimate out;
  out.odom_T_scan = odom_T_scan_ * motion;
  ErrorProcess::Matrix& transition = out.error.transition;
  transition.topLeftCorner<2, 2>() = turn;
  transition.block<2, 1>(0, 2) = turn * Eigen::Vector2d(-motion.y_m, motion.x_m);
  transition.topRightCorner<2, 2>() = driven_s * turn;
  const double walk = params_.speed_walk_sd_mps * params_.speed_walk_sd_mps;
  ErrorProcess::Matrix& noise = out.error.noise;
  noise.topLeftCorner<2, 2>().diagonal().setConstant(walk * period_s * period_s * period_s / 3.0);
  noise.topRightCorner<2, 2>() = 0.5 * walk * period_s * period_s * turn;
  noise.bottomLeftCorner<2, 2>() = noise.topRightCorner<2, 2>().transpose();
  noise.bottomRightCorner<2, 2>().diagonal().setConstant(walk * period_s);
  const double sd_rad = expected_reach(period_s).rotation_rad / kReach_deviations;
  noise(2, 2) = sd_rad * sd_rad;
  const ErrorProcess::Matrix ahead = out.error.after(covariance_);
  const double variance = ahead.bottomRightCorner<2, 2>().trace();
  const double kept = std::min(1.0, params_.speed_error_max_mps / std::sqrt(std::max(1e-12, variance)));
  ErrorProcess::Matrix bound = ErrorProcess::Matrix::Identity();
  bound.bottomRightCorner<2, 2>() *= kept;
  return {out.odom_T_scan, {covariance_, bound * transition, bound * noise * bound}};
}

MotionReach LaserOdometry::expected_reach(double period_s) const {
  // At a high rate the speed itself is uncertain: a match's error is divided by a short period. An expectation that
  // shrinks with the square of the period would then hold the estimate back where the robot starts or turns.
  // Stamps that are the same or run backwards say nothing of that.
  const double time_s =
      period_s > params_.period_min_s ? std::max(period_s, params_.expectation_period_min_s) : period_s;
  MotionReach reach = reach_of(limits_, time_s);
  if (!has_speed_) {
    reach.distance_m = std::max(reach.distance_m, limits_.speed_max_mps * time_s);
    reach.rotation_rad = std::max(reach.rotation_rad, limits_.turn_rate_max_radps * time_s);
  }
  return reach;
}

LaserOdometry::Estimate LaserOdometry::corrected(const Estimate& prediction, const Pose2& odom_T_key,
                                                 const MatchResult& match, double period_s) {
  const Pose2 key_T_scan = odom_T_key.inverse() * prediction.odom_T_scan;
  const Pose2 difference = key_T_scan.inverse() * match.reference_T_scan;
  Eigen::Matrix3d covariance = turned(covariance_over(match.covariance, period_s), -key_T_scan.yaw_rad);
  covariance.diagonal() +=
      Eigen::Vector3d(kMatch_sd_m * kMatch_sd_m, kMatch_sd_m * kMatch_sd_m, kMatch_sd_rad * kMatch_sd_rad);
  const ErrorProcess& ahead = prediction.error;
  const ErrorProcess::Matrix prior = ahead.after(covariance_);
  const Eigen::Matrix<double, 5, 3> gain =
      (prior.topLeftCorner<3, 3>() + covariance).ldlt().solve(prior.topRows<3>()).transpose();
  ErrorProcess::Matrix rest = ErrorProcess::Matrix::Identity();
  rest.leftCols<3>() -= gain;
  const ErrorProcess::Vector moved = gain * Eigen::Vector3d(difference.x_m, difference.y_m, difference.yaw_rad);
  speed_x_mps_ += moved(3);
  speed_y_mps_ += moved(4);
  Estimate out;
  out.odom_T_scan = prediction.odom_T_scan * Pose2{moved(0), moved(1), moved(2)};
  out.error.transition = rest * ahead.transition;
  out.error.noise = rest * ahead.noise * rest.transpose() + gain * covariance * gain.transpose();  // Joseph: never < 0
  return out;
}

Eigen::Matrix2d LaserOdometry::odom_slip(const Estimate& estimate, const Pose2& odom_T_key, const MatchResult& match) {
  const Eigen::Matrix2d held = match.covariance.topLeftCorner<2, 2>();
  const Eigen::Matrix2d error = estimate.error.after(covariance_).topLeftCorner<2, 2>();
  return slip_.match(turned(held, odom_T_key.yaw_rad), turned(error, estimate.odom_T_scan.yaw_rad));
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
  next_map_.odom_T_key = odom_T_scan;
  slip_.begin_map();
  next_map_.reference.begin_rebuild({placed_.data(), static_cast<std::size_t>(key_count_)});
  building_ = true;
}

void LaserOdometry::build_map(const Deadline& deadline) {
  for (int slices = 0; building_ && (slices < kSlices_sure || !deadline.expired()); ++slices) {
    if (next_map_.reference.rebuild_slice()) {
      std::swap(map_, next_map_);
      slip_.take_map();
      building_ = false;
    }
  }
}

}  // namespace odoless
