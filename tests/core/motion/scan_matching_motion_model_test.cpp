#include "core/motion/scan_matching_motion_model.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

namespace odoless {
namespace {

constexpr double kDegree_rad = std::numbers::pi / 180.0;
constexpr int kModelDraws = 200'000;

struct Moments {
  double mean = 0.0;
  double sd = 0.0;
  double largest = 0.0;
};

Moments moments(const std::vector<double>& values) {
  Moments m;
  for (const double value : values) {
    m.mean += value / static_cast<double>(values.size());
    m.largest = std::max(m.largest, std::abs(value));
  }
  for (const double value : values) {
    m.sd += (value - m.mean) * (value - m.mean) / static_cast<double>(values.size());
  }
  m.sd = std::sqrt(m.sd);
  return m;
}

/// Errors of many draws along the axes of the previous robot frame.
struct Errors {
  std::vector<double> forward_m, left_m, yaw_rad;
};

Errors draw(const MotionModelParams& params, const Pose2& increment, double lambda_m) {
  const ScanMatchingMotionModel model(params);
  Rng rng(5);
  Errors errors;
  for (int i = 0; i < kModelDraws; ++i) {
    const Pose2 pose = model.sample(Pose2{}, increment, lambda_m, rng);
    errors.forward_m.push_back(pose.x_m - increment.x_m);
    errors.left_m.push_back(pose.y_m - increment.y_m);
    errors.yaw_rad.push_back(wrap_angle(pose.yaw_rad - increment.yaw_rad));
  }
  return errors;
}

/// Deviations of a sample deviation are about sd / sqrt(2 n), of a mean sd / sqrt(n): five of them never happen.
void expect_noise(const std::vector<double>& errors, double v) {
  const Moments m = moments(errors);
  const double sd = v / 3.0;
  EXPECT_NEAR(m.mean, 0.0, 5.0 * sd / std::sqrt(kModelDraws));
  EXPECT_NEAR(m.sd, sd, 5.0 * sd / std::sqrt(2.0 * kModelDraws));
  EXPECT_LE(m.largest, 2.0 * v);
  EXPECT_GT(m.largest, 3.5 * sd);  // tails, not a box
}

TEST(ScanMatchingMotionModel, SpreadsEachAxisByTableOneWithDeviationOfAThirdOfV) {
  const Pose2 increment{0.4, -0.1, 20.0 * kDegree_rad};
  const Errors errors = draw({}, increment, 1.0);
  expect_noise(errors.forward_m, 0.02 + 0.4 / 10.0);
  expect_noise(errors.left_m, 0.02 + 0.1 / 10.0);
  expect_noise(errors.yaw_rad, (0.5 + 20.0 / 10.0) * kDegree_rad);
}

TEST(ScanMatchingMotionModel, SlipsForwardOnceInTwentyBySpeedTimesTime) {
  const double lambda_m = 1.0;
  const Errors errors = draw({}, Pose2{0.0, 0.0, 2.9 * kDegree_rad}, lambda_m);
  std::vector<double> lobe;
  std::vector<double> core;
  for (const double error_m : errors.forward_m) {
    (error_m > 0.041 ? lobe : core).push_back(error_m);
  }
  const auto slips = static_cast<double>(lobe.size());
  EXPECT_NEAR(slips / kModelDraws, 0.05, 5.0 * std::sqrt(0.05 * 0.95 / kModelDraws));
  const Moments m = moments(lobe);
  EXPECT_NEAR(m.mean, lambda_m, 5.0 * lambda_m / 6.0 / std::sqrt(slips));
  EXPECT_NEAR(m.sd, lambda_m / 6.0, 5.0 * lambda_m / 6.0 / std::sqrt(2.0 * slips));
  EXPECT_NEAR(moments(core).sd, 0.02 / 3.0, 2e-4);
}

TEST(ScanMatchingMotionModel, NeverSlipsWhenTheMatchTurnedByThreeDegreesOrMore) {
  for (const double turn_deg : {3.0, -3.0, 45.0, -45.0}) {
    const Errors errors = draw({}, Pose2{0.0, 0.0, turn_deg * kDegree_rad}, 1.0);
    EXPECT_LE(moments(errors.forward_m).largest, 0.04) << turn_deg;
  }
}

TEST(ScanMatchingMotionModel, SlipsWhenTheMatchTurnedAlittleEitherWay) {
  for (const double turn_deg : {2.9, -2.9, 0.0}) {
    const Errors errors = draw({}, Pose2{0.0, 0.0, turn_deg * kDegree_rad}, 1.0);
    EXPECT_GT(moments(errors.forward_m).largest, 1.0) << turn_deg;
  }
}

/// Table 5.1 as printed: the robot looks along y, the heading is that of the y axis.
Pose2 compose_as_printed(const Pose2& robot, double dx_m, double dy_m, double dtheta_rad) {
  const double d_m = std::sqrt(dx_m * dx_m + dy_m * dy_m);
  const double alpha_rad = robot.yaw_rad - std::numbers::pi / 2.0 + std::atan2(dy_m, dx_m);
  return {robot.x_m + d_m * std::cos(alpha_rad), robot.y_m + d_m * std::sin(alpha_rad),
          wrap_angle(robot.yaw_rad + dtheta_rad)};
}

TEST(ScanMatchingMotionModel, ComposesPosesAsThePrintedTableDoesInItsOwnFrame) {
  MotionModelParams exact;
  exact.translation_spread_m = exact.translation_spread_ratio = exact.slip_probability = 0.0;
  exact.rotation_spread_rad = exact.rotation_spread_ratio = 0.0;
  const ScanMatchingMotionModel model(exact);
  Rng rng(9);
  for (int i = 0; i < 1000; ++i) {
    const Pose2 robot{rng.uniform(-9.0, 9.0), rng.uniform(-9.0, 9.0), rng.uniform(-3.1, 3.1)};
    const Pose2 increment{rng.uniform(-1.0, 1.0), rng.uniform(-1.0, 1.0), rng.uniform(-1.0, 1.0)};
    const Pose2 expected = compose_as_printed(robot, -increment.y_m, increment.x_m, increment.yaw_rad);
    const Pose2 pose = model.sample(robot, increment, 0.3, rng);
    EXPECT_NEAR(pose.x_m, expected.x_m, 1e-12);
    EXPECT_NEAR(pose.y_m, expected.y_m, 1e-12);
    EXPECT_NEAR(wrap_angle(pose.yaw_rad - expected.yaw_rad), 0.0, 1e-12);
  }
}

TEST(ScanMatchingMotionModel, DrawsTheSameForTheSameSeedAndMirrorsTheTablesAxes) {
  const ScanMatchingMotionModel model({});
  Rng rng(3);
  Rng twin(3);
  const auto sample_a = [&twin](double v) {  // Table 5.2, on the twin generator
    double sum = 0.0;
    for (int i = 0; i < 12; ++i) {
      sum += twin.uniform(-1.0, 1.0);
    }
    return v / 6.0 * sum;
  };
  for (int i = 0; i < 1000; ++i) {
    const Pose2 robot{0.3, -2.0, 0.7};
    const Pose2 increment{0.2, 0.05, 0.02};
    const double dx_m = -increment.y_m + sample_a(0.02 + 0.05 / 10.0);
    const bool lobe = twin.uniform() > 0.95;
    const double dy_m = increment.x_m + (lobe ? sample_a(0.25 / 2.0) + 0.25 : sample_a(0.02 + 0.2 / 10.0));
    const double dtheta_rad = increment.yaw_rad + sample_a(0.5 * kDegree_rad + 0.02 / 10.0);
    const Pose2 expected = compose_as_printed(robot, dx_m, dy_m, dtheta_rad);
    const Pose2 pose = model.sample(robot, increment, 0.25, rng);
    EXPECT_NEAR(pose.x_m, expected.x_m, 1e-12);
    EXPECT_NEAR(pose.y_m, expected.y_m, 1e-12);
    EXPECT_NEAR(pose.yaw_rad, expected.yaw_rad, 1e-12);
  }
}

}  // namespace
}  // namespace odoless
