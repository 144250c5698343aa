#include "core/motion/motion.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <vector>

#include "core/geometry/pose2_covariance.hpp"

namespace odoless {
namespace {

constexpr double kSmall = 1e-3;  // errors whose squares count for nothing
constexpr int kMotionDraws = 40'000;

Pose2 random_pose(Rng& rng) { return {rng.uniform(-2.0, 2.0), rng.uniform(-2.0, 2.0), rng.uniform(-3.0, 3.0)}; }

ErrorProcess::Matrix random_covariance(Rng& rng) {
  ErrorProcess::Matrix root;
  for (int i = 0; i < root.size(); ++i) {
    root(i) = kSmall * rng.normal();
  }
  return root * root.transpose();
}

/// The errors before are partly mended, and those of the speed go on.
ErrorProcess random_process(const Pose2& previous_T_current, Rng& rng) {
  ErrorProcess process;
  process.initial = random_covariance(rng);
  for (int i = 0; i < process.transition.size(); ++i) {
    process.transition(i) = 0.3 * rng.normal();
  }
  process.transition.topLeftCorner<3, 3>() += 0.7 * adjoint(previous_T_current.inverse());
  process.noise = random_covariance(rng);
  return process;
}

/// One that may follow `before`, or begin a run.
Motion random_motion(Rng& rng, const Motion& before = {}) {
  const auto period_ns = static_cast<std::int64_t>(rng.below(1'000'000));
  Motion motion = Motion::between(before.to_stamp_ns, before.to_stamp_ns + period_ns, random_pose(rng));
  motion.duration_ns = static_cast<std::int64_t>(rng.below(1'000'000));
  motion.duration_sd_s = rng.uniform();
  motion.odom_T_current = before.odom_T_current * motion.previous_T_current;
  ErrorProcess process = random_process(motion.previous_T_current, rng);
  process.initial = before.steps > 0 ? before.error().after(before.error().initial) : process.initial;
  motion.set_error(process);
  motion.fitness = rng.uniform();
  motion.score = rng.uniform();
  motion.second_peak_ratio = rng.uniform();
  motion.strong_information_1_m2 = rng.uniform();
  motion.weak_information_1_m2 = rng.uniform();
  motion.evaluations = static_cast<std::int32_t>(rng.below(10'000));
  motion.flags = rng.below(kMotionFlags + 1);
  motion.log_weight = rng.uniform(-1.0, 0.0);
  return motion;
}

void expect_same_pose(const Pose2& a, const Pose2& b) {
  EXPECT_NEAR(a.x_m, b.x_m, 1e-12);
  EXPECT_NEAR(a.y_m, b.y_m, 1e-12);
  EXPECT_NEAR(wrap_angle(a.yaw_rad - b.yaw_rad), 0.0, 1e-12);
}

void expect_same(const Motion& a, const Motion& b) {
  EXPECT_EQ(a.from_stamp_ns, b.from_stamp_ns);
  EXPECT_EQ(a.to_stamp_ns, b.to_stamp_ns);
  EXPECT_EQ(a.duration_ns, b.duration_ns);
  EXPECT_NEAR(a.duration_sd_s, b.duration_sd_s, 1e-12);
  expect_same_pose(a.previous_T_current, b.previous_T_current);
  expect_same_pose(a.odom_T_current, b.odom_T_current);
  EXPECT_LT((a.error().initial - b.error().initial).norm(), 1e-12);
  EXPECT_LT((a.error().transition - b.error().transition).norm(), 1e-10);
  EXPECT_LT((a.error().noise - b.error().noise).norm(), 1e-12);
  EXPECT_LT((a.covariance() - b.covariance()).norm(), 1e-12);
  EXPECT_EQ(a.fitness, b.fitness);
  EXPECT_EQ(a.score, b.score);
  EXPECT_EQ(a.second_peak_ratio, b.second_peak_ratio);
  EXPECT_EQ(a.strong_information_1_m2, b.strong_information_1_m2);
  EXPECT_EQ(a.weak_information_1_m2, b.weak_information_1_m2);
  EXPECT_EQ(a.evaluations, b.evaluations);
  EXPECT_EQ(a.steps, b.steps);
  EXPECT_EQ(a.flags, b.flags);
  EXPECT_NEAR(a.log_weight, b.log_weight, 1e-12);
  EXPECT_EQ(a.alternative_count, b.alternative_count);
}

bool has_same_bytes(const Motion& a, const Motion& b) { return std::memcmp(&a, &b, sizeof(Motion)) == 0; }

TEST(Motion, AddsUpSlipsInTheAxesThatItBeginsWith) {
  Motion turn = Motion::between(0, 1, {1.0, 0.0, std::numbers::pi / 2.0});
  Motion slip = Motion::between(1, 2, {1.0, 0.0, 0.0});
  slip.set_map_slip(Eigen::Vector2d(0.25, 0.0).asDiagonal());
  turn.set_map_slip(Eigen::Vector2d(0.0625, 0.0).asDiagonal());
  const Eigen::Matrix2d sum = matrix_of<2>(turn.then(slip).map_slip);
  EXPECT_NEAR(sum(0, 0), 0.0625, 1e-11);
  EXPECT_NEAR(sum(1, 1), 0.25, 1e-11);
  EXPECT_NEAR(sum(0, 1), 0.0, 1e-11);
}

// So it goes from one host to another, however small one is beside the other.
TEST(Motion, ItsSlipComesOutOfItsCovarianceBitForBit) {
  Rng rng(3);
  for (int i = 0; i < 1000; ++i) {
    Motion motion = random_motion(rng);
    ErrorProcess process = motion.error();
    process.noise *= std::exp2(rng.uniform(-40.0, 8.0));
    motion.set_error(process);
    ASSERT_LT(motion.covariance().trace(), 2048.0);
    const double scale = std::exp2(rng.uniform(-20.0, 5.0));
    const Eigen::Vector2d along = scale * Eigen::Vector2d(rng.uniform(-1.0, 1.0), rng.uniform(-1.0, 1.0));
    motion.set_map_slip(i % 2 == 0 ? Eigen::Matrix2d(along * along.transpose()) : Eigen::Matrix2d::Zero());
    Motion other = motion;
    other.map_slip = {1.0, 2.0, 3.0, 4.0};
    other.set_slip_of(motion.covariance_with_slip());
    EXPECT_TRUE(has_same_bytes(other, motion)) << i;
  }
}

// Its last digits, which are all that a slip would be, are rounded away.
TEST(Motion, NoSlipComesOutOfACovarianceThatIsTooLarge) {
  Rng rng(3);
  for (int i = 0; i < 100; ++i) {
    Motion motion = random_motion(rng);
    ErrorProcess process = motion.error();
    process.noise.diagonal().array() += 1e9;
    motion.set_error(process);
    motion.set_slip_of(motion.covariance_with_slip() * (1.0 + 1e-15));
    EXPECT_EQ(motion.map_slip, (MatrixRows<2>{})) << i;
  }
}

TEST(Motion, HasNoSlipThatIsNoCovariance) {
  Motion motion = Motion::between(0, 1, {});
  for (const double bad : {-0.1, std::numeric_limits<double>::quiet_NaN()}) {
    motion.set_map_slip(Eigen::Vector2d(0.25, bad).asDiagonal());
    EXPECT_EQ(motion.map_slip, (MatrixRows<2>{})) << bad;
  }
}

TEST(Motion, ComposesToTheSameInWhateverOrder) {
  Rng rng(1);
  for (int i = 0; i < 200; ++i) {
    const Motion a = random_motion(rng);
    const Motion b = random_motion(rng, a);
    const Motion c = random_motion(rng, b);
    ASSERT_NO_FATAL_FAILURE(expect_same(a.then(b).then(c), a.then(b.then(c)))) << i;
  }
}

TEST(Motion, ComposedOfManyIsTheirProduct) {
  Rng rng(2);
  Motion sum;
  Motion last;
  Pose2 first_T_last;
  std::int64_t duration_ns = 0;
  for (int i = 0; i < 100; ++i) {
    last = random_motion(rng, last);
    sum = sum.then(last);
    first_T_last = first_T_last * last.previous_T_current;
    duration_ns += last.duration_ns;
  }
  expect_same_pose(sum.previous_T_current, first_T_last);
  expect_same_pose(sum.odom_T_current, last.odom_T_current);
  EXPECT_EQ(sum.steps, 100);
  EXPECT_EQ(sum.duration_ns, duration_ns);
  EXPECT_EQ(sum.from_stamp_ns, 0);
  EXPECT_EQ(sum.to_stamp_ns, last.to_stamp_ns);
}

TEST(Motion, NoMotionChangesNothing) {
  Rng rng(3);
  Motion motion = random_motion(rng);
  motion.alternatives[0] = {random_pose(rng), -1.0, {}};
  motion.alternative_count = 1;
  EXPECT_TRUE(has_same_bytes(Motion{}.then(motion), motion));
  EXPECT_TRUE(has_same_bytes(motion.then(Motion{}), motion));
}

TEST(Motion, RemembersWhatWasWrongWithAPart) {
  Motion good = Motion::between(0, 1, {});
  good.fitness = good.score = 0.8;
  good.weak_information_1_m2 = 100.0;
  Motion bad = good;
  bad.flags = kEscalated | kRejected | kJolted | kDeadlineHit;
  bad.fitness = bad.score = 0.1;
  bad.second_peak_ratio = 0.9;
  bad.weak_information_1_m2 = 1.0;
  for (const Motion& sum : {good.then(bad), bad.then(good)}) {
    EXPECT_EQ(sum.flags, bad.flags);
    EXPECT_EQ(sum.fitness, 0.1);
    EXPECT_EQ(sum.score, 0.1);
    EXPECT_EQ(sum.second_peak_ratio, 0.9);
    EXPECT_EQ(sum.weak_information_1_m2, 1.0);
  }
  EXPECT_EQ(good.then(good).flags, good.flags);
}

Pose2 drawn_pose(const ErrorProcess::Vector& error) { return {error(0), error(1), error(2)}; }

ErrorProcess::Vector drawn(const ErrorProcess::Matrix& root, Rng& rng) {
  ErrorProcess::Vector normals;
  for (int i = 0; i < normals.size(); ++i) {
    normals(i) = rng.normal();
  }
  return root * normals;
}

/// Covariance of the true motion from the begin of the first to the end of the last, by trial.
Eigen::Matrix3d covariance_by_trial(const std::vector<Motion>& motions, Rng& rng) {
  Pose2 first_T_last;
  for (const Motion& motion : motions) {
    first_T_last = first_T_last * motion.previous_T_current;
  }
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  const ErrorProcess::Matrix initial_root = root_of(motions.front().error().initial);
  for (int i = 0; i < kMotionDraws; ++i) {
    const ErrorProcess::Vector before = drawn(initial_root, rng);
    ErrorProcess::Vector error = before;
    for (const Motion& motion : motions) {
      error = (motion.error().transition * error + drawn(root_of(motion.error().noise), rng)).eval();
    }
    const Pose2 truth = drawn_pose(before).inverse() * first_T_last * drawn_pose(error);
    const Eigen::Vector3d off(truth.x_m - first_T_last.x_m, truth.y_m - first_T_last.y_m,
                              wrap_angle(truth.yaw_rad - first_T_last.yaw_rad));
    covariance += off * off.transpose() / kMotionDraws;
  }
  return covariance;
}

TEST(Motion, HasTheCovarianceOfItsSimulatedErrors) {
  Rng rng(4);
  for (int i = 0; i < 4; ++i) {
    const Motion a = random_motion(rng);
    const Motion b = random_motion(rng, a);
    const Motion c = random_motion(rng, b);
    const Eigen::Matrix3d trial = covariance_by_trial({a, b, c}, rng);
    const Eigen::Matrix3d stated = a.then(b).then(c).covariance();
    EXPECT_LT((stated - trial).norm(), 0.05 * trial.norm()) << stated << "\n\n" << trial;
  }
}

// A yaw that is off by 1 mrad puts what lies 10 m ahead 10 mm aside.
TEST(Motion, HasTheLeverArmOfTheYawInItsCovariance) {
  Motion turn = Motion::between(0, 1, {0.0, 0.0, 0.5});
  turn.set_error(ErrorProcess::independent(turn.previous_T_current, Eigen::Vector3d(0.0, 0.0, 1e-6).asDiagonal()));
  Motion ahead = Motion::between(1, 2, {10.0, 0.0, 0.0});
  ahead.set_error(ErrorProcess::independent(ahead.previous_T_current, Eigen::Matrix3d::Zero()));
  const Eigen::Matrix3d covariance = turned(turn.then(ahead).covariance(), -0.5);
  EXPECT_NEAR(covariance(0, 0), 0.0, 1e-12);
  EXPECT_NEAR(covariance(1, 1), 1e-4, 1e-12);
  EXPECT_NEAR(covariance(1, 2), 1e-5, 1e-12);
}

// Of two parts that are equal and independent; the same by the error process and by the covariances alone.
TEST(Motion, ComposesIndependentErrorsAsCovariancesCompose) {
  Rng rng(5);
  const Eigen::Matrix3d covariance = random_covariance(rng).topLeftCorner<3, 3>();
  Motion a = Motion::between(0, 1, random_pose(rng));
  Motion b = Motion::between(1, 2, random_pose(rng));
  a.set_error(ErrorProcess::independent(a.previous_T_current, covariance));
  b.set_error(ErrorProcess::independent(b.previous_T_current, covariance));
  const Eigen::Matrix3d expected =
      composed_covariance(a.previous_T_current, a.covariance(), b.previous_T_current, b.covariance());
  EXPECT_LT((a.then(b).covariance() - expected).norm(), 1e-12);
}

// As along a corridor: 0.5 m less or more, with a weight of 1 to e.
Motion slipping() {
  Motion motion = Motion::between(0, 1, {1.0, 0.0, 0.0});
  motion.alternatives[0] = {{0.5, 0.0, 0.0}, -1.0, {1e-4, 0, 0, 0, 1e-4, 0, 0, 0, 1e-5}};
  motion.alternative_count = 1;
  return motion;
}

TEST(Motion, ComposesEachHypothesisWithEachAndTakesThoseThatMeetTogether) {
  const Motion sum = slipping().then(slipping());
  EXPECT_EQ(sum.previous_T_current.x_m, 2.0);
  EXPECT_EQ(sum.log_weight, 0.0);
  ASSERT_EQ(sum.alternative_count, 2);
  EXPECT_NEAR(sum.alternatives[0].previous_T_current.x_m, 1.5, 1e-12);
  EXPECT_NEAR(sum.alternatives[0].log_weight, std::log(2.0) - 1.0, 1e-12);
  EXPECT_NEAR(sum.alternatives[0].covariance[0], 1e-4, 1e-12) << "one of the two slipped";
  EXPECT_NEAR(sum.alternatives[1].previous_T_current.x_m, 1.0, 1e-12);
  EXPECT_NEAR(sum.alternatives[1].log_weight, -2.0, 1e-12);
  EXPECT_NEAR(sum.alternatives[1].covariance[0], 2e-4, 1e-12);
  EXPECT_NEAR(sum.alternatives[1].covariance[4], 2e-4 + 1e-5 * 0.5 * 0.5, 1e-12) << "the lever arm of the second";
}

TEST(Motion, TakesHypothesesThatMeetTheBestForIt) {
  Motion there = slipping();
  Motion back = Motion::between(1, 2, {-1.0, 0.0, 0.0});
  back.alternatives[0] = {{-0.52, 0.0, 0.0}, -1.0, {}};
  back.alternative_count = 1;
  const Motion sum = there.then(back);
  EXPECT_NEAR(sum.log_weight, std::log1p(std::exp(-2.0)), 1e-12);
  EXPECT_EQ(sum.alternative_count, 2);
  EXPECT_EQ(sum.previous_T_current.x_m, 0.0);
}

TEST(Motion, KeepsTheHeaviestHypotheses) {
  Rng rng(6);
  for (int i = 0; i < 50; ++i) {
    Motion a = random_motion(rng);
    Motion b = random_motion(rng, a);
    for (std::size_t k = 0; k < Motion::kAlternativesMax; ++k) {
      a.alternatives[k] = {random_pose(rng), -rng.uniform(1.0, 5.0), {}};
      b.alternatives[k] = {random_pose(rng), -rng.uniform(1.0, 5.0), {}};
    }
    a.alternative_count = b.alternative_count = static_cast<int>(Motion::kAlternativesMax);
    const Motion sum = a.then(b);
    ASSERT_TRUE(has_same_bytes(sum, a.then(b)));
    ASSERT_EQ(sum.alternative_count, static_cast<int>(Motion::kAlternativesMax));
    std::vector<double> weights{};
    for (const MotionHypothesis& first : a.others()) {
      weights.push_back(first.log_weight + b.log_weight);
      for (const MotionHypothesis& next : b.others()) {
        weights.push_back(first.log_weight + next.log_weight);
      }
    }
    for (const MotionHypothesis& next : b.others()) {
      weights.push_back(a.log_weight + next.log_weight);
    }
    std::sort(weights.rbegin(), weights.rend());
    for (std::size_t k = 0; k < Motion::kAlternativesMax; ++k) {
      ASSERT_GE(sum.alternatives[k].log_weight, weights[k] - 1e-12) << "more where some met";
      ASSERT_TRUE(k == 0 || sum.alternatives[k].log_weight <= sum.alternatives[k - 1].log_weight);
    }
  }
}

TEST(Motion, SaturatesWhereANetworkToldTooMuch) {
  Motion motion = Motion::between(0, INT64_MAX, {});
  motion.evaluations = motion.steps = INT32_MAX;
  const Motion sum = motion.then(motion);
  EXPECT_EQ(sum.duration_ns, INT64_MAX);
  EXPECT_EQ(sum.evaluations, INT32_MAX);
  EXPECT_EQ(sum.steps, INT32_MAX);
}

TEST(Pose2Covariance, AdjointTakesASmallMotionToOtherAxes) {
  Rng rng(7);
  for (int i = 0; i < 20; ++i) {
    const Pose2 a_T_b = random_pose(rng);
    const Eigen::Vector3d motion(1e-7 * rng.normal(), 1e-7 * rng.normal(), 1e-7 * rng.normal());
    const Pose2 moved = a_T_b * Pose2{motion.x(), motion.y(), motion.z()} * a_T_b.inverse();
    EXPECT_LT((adjoint(a_T_b) * motion - Eigen::Vector3d(moved.x_m, moved.y_m, moved.yaw_rad)).norm(), 1e-12);
  }
}

TEST(ProbabilityWithin, FollowsTheLargestDeviationInWhateverDirectionItIs) {
  Eigen::Matrix3d covariance = Eigen::Vector3d(0.25, 1e-4, 1e-6).asDiagonal();
  EXPECT_NEAR(probability_within(covariance, 0.5, 0.1), 0.6827, 1e-3) << "one deviation";
  EXPECT_NEAR(probability_within(turned(covariance, 0.7), 0.5, 0.1), 0.6827, 1e-3);
  covariance(2, 2) = 0.01;
  EXPECT_NEAR(probability_within(covariance, 0.5, 0.1), 0.6827 * 0.6827, 1e-3);
  EXPECT_EQ(probability_within(Eigen::Matrix3d::Zero(), 0.5, 0.1), 1.0);
}

}  // namespace
}  // namespace odoless
