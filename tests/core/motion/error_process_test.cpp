#include "core/motion/error_process.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace odoless {
namespace {

constexpr int kDraws = 40'000;

ErrorProcess::Matrix random_matrix(Rng& rng) {
  ErrorProcess::Matrix m;
  for (int i = 0; i < m.size(); ++i) {
    m(i) = rng.normal();
  }
  return m;
}

ErrorProcess random_process(Rng& rng) {
  const ErrorProcess::Matrix root = random_matrix(rng);
  return {ErrorProcess::Matrix::Zero(), 0.5 * random_matrix(rng), root * root.transpose()};
}

TEST(ErrorProcess, RootSquaresToTheCovarianceEvenWhereItIsSingular) {
  Rng rng(1);
  for (int i = 0; i < 100; ++i) {
    ErrorProcess::Matrix root = random_matrix(rng);
    if (i % 2 == 1) {
      root.row(i % ErrorProcess::kSize).setZero();
    }
    const ErrorProcess::Matrix covariance = root * root.transpose();
    const ErrorProcess::Matrix found = root_of(covariance);
    EXPECT_LT((found * found.transpose() - covariance).norm(), 1e-9);
  }
  EXPECT_EQ(root_of(ErrorProcess::Matrix::Zero()), ErrorProcess::Matrix::Zero());
}

TEST(ErrorProcess, DrawnOverTwoMotionsSpreadsAsTheirSumSays) {
  Rng rng(2);
  const ErrorProcess first = random_process(rng);
  const ErrorProcess second = random_process(rng);
  const ErrorProcess both = first.then(second);
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (int i = 0; i < kDraws; ++i) {
    DrawnError error;
    error.advance(first, root_of(first.noise), rng);
    error.advance(second, root_of(second.noise), rng);
    const Pose2 pose = error.pose();
    const Eigen::Vector3d v(pose.x_m, pose.y_m, pose.yaw_rad);
    covariance += v * v.transpose() / kDraws;
  }
  const Eigen::Matrix3d expected = both.noise.topLeftCorner<3, 3>();
  EXPECT_LT((covariance - expected).norm(), 0.05 * expected.norm());
}

TEST(ErrorProcess, OneThatTheSceneMendsGoesAwayAndOneOfTheSpeedGrows) {
  Rng rng(3);
  ErrorProcess mended;
  mended.transition.setZero();
  ErrorProcess slipped;
  slipped.transition(0, 3) = 0.2;  // 0.2 s
  ErrorProcess::Matrix root = ErrorProcess::Matrix::Zero();
  root(3, 3) = 1.0;
  DrawnError error;
  error.advance(ErrorProcess{}, root, rng);
  const ErrorProcess::Matrix none = ErrorProcess::Matrix::Zero();
  error.advance(slipped, none, rng);
  const double once_m = error.pose().x_m;
  EXPECT_NE(once_m, 0.0);
  for (int i = 0; i < 9; ++i) {
    error.advance(slipped, none, rng);
  }
  EXPECT_NEAR(error.pose().x_m, 10.0 * once_m, 1e-12);
  error.advance(mended, none, rng);
  EXPECT_EQ(error.pose().x_m, 0.0);
}

TEST(ErrorProcess, IndependentOnesAddUp) {
  const Eigen::Matrix3d covariance = Eigen::Vector3d(0.01, 0.02, 0.03).asDiagonal();
  const ErrorProcess step = ErrorProcess::independent({}, covariance);
  EXPECT_TRUE((step.then(step).noise.topLeftCorner<3, 3>()).isApprox(2.0 * covariance));
}

}  // namespace
}  // namespace odoless
