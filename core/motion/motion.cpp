#include "core/motion/motion.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/geometry/pose2_covariance.hpp"
#include "core/math/elementary.hpp"

namespace odoless {
namespace {

// 2^40: a step is twice what a sum with kOwnVarianceMax_m2 is rounded by, and the slip comes out of it as it was.
constexpr double kSteps_per_m2 = 1099511627776.0;
constexpr double kOwnVarianceMax_m2 = 2048.0;

constexpr double kSame_m = 0.1;
constexpr double kSame_rad = 2.0 * std::numbers::pi / 180.0;
constexpr std::uint32_t kOfBoth = kMatched | kConverged;
constexpr std::size_t kHypothesesMax = Motion::kAlternativesMax + 1;

/// All hypotheses of a motion, that of its own first.
struct Hypotheses {
  std::array<MotionHypothesis, kHypothesesMax> each{};
  std::size_t count = 0;

  explicit Hypotheses(const Motion& motion) {
    each[count++] = {motion.previous_T_current, motion.log_weight, rows_of<3>(motion.covariance())};
    for (const MotionHypothesis& other : motion.others()) {
      each[count++] = other;
    }
  }
};

MotionHypothesis composed(const MotionHypothesis& first, const MotionHypothesis& next) {
  return {first.previous_T_current * next.previous_T_current, first.log_weight + next.log_weight,
          rows_of<3>(composed_covariance(first.previous_T_current, matrix_of<3>(first.covariance),
                                         next.previous_T_current, matrix_of<3>(next.covariance)))};
}

/// Whatever a network told.
template <class Integer>
Integer saturated_sum(Integer a, Integer b) {
  Integer sum = 0;
  const bool overflows = __builtin_add_overflow(a, b, &sum);
  return overflows ? (a > 0 ? std::numeric_limits<Integer>::max() : std::numeric_limits<Integer>::min()) : sum;
}

double log_sum(double a, double b) { return std::max(a, b) + math::log1p(math::exp(-std::abs(a - b))); }

bool is_same(const Pose2& a, const Pose2& b) {
  return a.distance_m(b) < kSame_m && std::abs(wrap_angle(a.yaw_rad - b.yaw_rad)) < kSame_rad;
}

/// Adds a hypothesis that is no heavier than those that are there.
void add(const MotionHypothesis& hypothesis, Motion& sum) {
  if (is_same(sum.previous_T_current, hypothesis.previous_T_current)) {
    sum.log_weight = log_sum(sum.log_weight, hypothesis.log_weight);
    return;
  }
  const auto end = sum.alternatives.begin() + sum.alternative_count;
  const auto same = std::find_if(sum.alternatives.begin(), end, [&](const MotionHypothesis& other) {
    return is_same(other.previous_T_current, hypothesis.previous_T_current);
  });
  if (same != end) {
    same->log_weight = log_sum(same->log_weight, hypothesis.log_weight);
  } else if (end != sum.alternatives.end()) {
    *end = hypothesis;
    ++sum.alternative_count;
  }
}

bool is_heavier(const MotionHypothesis& a, const MotionHypothesis& b) { return a.log_weight > b.log_weight; }

void compose_alternatives(const Motion& first, const Motion& next, Motion& sum) {
  const Hypotheses firsts(first);
  const Hypotheses nexts(next);
  std::array<MotionHypothesis, kHypothesesMax * kHypothesesMax> all;
  auto end = all.begin();
  for (std::size_t i = 0; i < firsts.count; ++i) {
    for (std::size_t k = i == 0 ? 1 : 0; k < nexts.count; ++k) {
      const MotionHypothesis each = composed(firsts.each[i], nexts.each[k]);
      const auto at = std::upper_bound(all.begin(), end, each, is_heavier);  // of equal ones the earlier stays first
      std::move_backward(at, end, end + 1);
      *at = each;
      ++end;
    }
  }
  std::for_each(all.begin(), end, [&sum](const MotionHypothesis& each) { add(each, sum); });
  const auto others = std::span(sum.alternatives).first(static_cast<std::size_t>(sum.alternative_count));
  for (auto each = others.begin(); each != others.end(); ++each) {  // adding up may have changed their order
    std::rotate(std::upper_bound(others.begin(), each, *each, is_heavier), each, each + 1);
  }
}

}  // namespace

Velocity2 Motion::velocity() const {
  const double period_s = duration_s();
  if (!matched() || period_s <= 0.0) {
    return {};
  }
  const Point2 way_m =
      Pose2{0.0, 0.0, -previous_T_current.yaw_rad} * Point2{previous_T_current.x_m, previous_T_current.y_m};
  return {way_m.x_m / period_s, way_m.y_m / period_s, previous_T_current.yaw_rad / period_s};
}

Motion Motion::between(std::int64_t from_stamp_ns, std::int64_t to_stamp_ns, const Pose2& previous_T_current) {
  Motion motion;
  motion.from_stamp_ns = from_stamp_ns;
  motion.to_stamp_ns = to_stamp_ns;
  motion.duration_ns = to_stamp_ns - from_stamp_ns;
  motion.previous_T_current = previous_T_current;
  motion.steps = 1;
  motion.flags = kMatched | kConverged;
  return motion;
}

ErrorProcess Motion::error() const {
  return {matrix_of<5>(error_initial), matrix_of<5>(error_transition), matrix_of<5>(error_noise)};
}

void Motion::set_error(const ErrorProcess& error) {
  error_initial = rows_of<5>(error.initial);
  error_transition = rows_of<5>(error.transition);
  error_noise = rows_of<5>(error.noise);
}

Eigen::Matrix3d Motion::covariance() const {
  return turned(error().motion_covariance(previous_T_current), previous_T_current.yaw_rad);
}

Eigen::Matrix3d Motion::covariance_with_slip() const {
  Eigen::Matrix3d sum = covariance();
  sum.topLeftCorner<2, 2>() += matrix_of<2>(map_slip);
  return sum;
}

void Motion::set_slip_of(const Eigen::Matrix3d& covariance_with_slip) {
  const Eigen::Matrix2d own = covariance().topLeftCorner<2, 2>();
  const Eigen::Matrix2d slip = covariance_with_slip.topLeftCorner<2, 2>() - own;
  set_map_slip(own.trace() < kOwnVarianceMax_m2 ? slip : Eigen::Matrix2d::Zero());
}

void Motion::set_map_slip(const Eigen::Matrix2d& slip) {
  const Eigen::Matrix2d symmetric = 0.5 * (slip + slip.transpose());
  const Eigen::Matrix2d rounded = (symmetric * kSteps_per_m2).array().round() / kSteps_per_m2 + 0.0;  // no -0
  const Eigen::Array2d variances = rounded.diagonal().array() + 1.0 / kSteps_per_m2;
  const bool is_covariance =
      rounded(0, 0) >= 0.0 && rounded(1, 1) >= 0.0 && rounded(0, 1) * rounded(0, 1) <= variances(0) * variances(1);
  map_slip = is_covariance ? rows_of<2>(rounded) : MatrixRows<2>{};
}

double Motion::weight() const {
  double sum = 1.0;
  for (const MotionHypothesis& other : others()) {
    sum += math::exp(other.log_weight - log_weight);
  }
  return 1.0 / sum;
}

const Pose2& Motion::at_share(double share) const {
  const double own = weight();
  double sum = own;
  const MotionHypothesis* chosen = nullptr;
  for (const MotionHypothesis& other : others()) {
    if (share >= sum) {
      chosen = &other;
    }
    sum += own * math::exp(other.log_weight - log_weight);
  }
  return chosen == nullptr ? previous_T_current : chosen->previous_T_current;
}

Motion Motion::then(const Motion& next) const {
  if (steps == 0 || next.steps == 0) {
    return steps == 0 ? next : *this;
  }
  Motion sum;
  sum.from_stamp_ns = from_stamp_ns;
  sum.to_stamp_ns = next.to_stamp_ns;
  sum.duration_ns = saturated_sum(duration_ns, next.duration_ns);
  sum.duration_sd_s = math::hypot(duration_sd_s, next.duration_sd_s);
  sum.previous_T_current = previous_T_current * next.previous_T_current;
  sum.odom_T_current = next.odom_T_current;
  sum.set_error(error().then(next.error()));
  sum.set_map_slip(matrix_of<2>(map_slip) + turned(matrix_of<2>(next.map_slip), previous_T_current.yaw_rad));
  sum.fitness = std::min(fitness, next.fitness);
  sum.score = std::min(score, next.score);
  sum.second_peak_ratio = std::max(second_peak_ratio, next.second_peak_ratio);
  sum.strong_information_1_m2 = std::min(strong_information_1_m2, next.strong_information_1_m2);
  sum.weak_information_1_m2 = std::min(weak_information_1_m2, next.weak_information_1_m2);
  sum.evaluations = saturated_sum(evaluations, next.evaluations);
  sum.steps = saturated_sum(steps, next.steps);
  sum.flags = (flags & next.flags & kOfBoth) | ((flags | next.flags) & ~kOfBoth);
  sum.probability = probability * next.probability;
  sum.log_weight = log_weight + next.log_weight;
  if (alternative_count + next.alternative_count > 0) {
    compose_alternatives(*this, next, sum);
  }
  return sum;
}

}  // namespace odoless
