#pragma once

#include <Eigen/Core>
#include <cmath>

namespace odoless {

/// How a motion estimate errs, as a linear process: what a tracker knows of its own error beyond one covariance.
///
/// The error is (x_m, y_m, yaw_rad, vx_mps, vy_mps): true pose = tracked pose * (x_m, y_m, yaw_rad), true speed =
/// tracked speed + (vx_mps, vy_mps), both in the axes of the scan. Over a motion it becomes carried * error + noise. So
/// an error that the scene mends goes away, and one of the speed along a featureless wall grows from step to step
/// instead of cancelling out.
struct MotionError {
  static constexpr int kSize = 5;
  using Vector = Eigen::Matrix<double, kSize, 1>;
  using Matrix = Eigen::Matrix<double, kSize, kSize>;

  Matrix carried = Matrix::Identity();
  Matrix noise = Matrix::Zero();  ///< covariance

  /// The error of this motion followed by the next.
  [[nodiscard]] MotionError then(const MotionError& next) const {
    return {next.carried * carried, next.carried * noise * next.carried.transpose() + next.noise};
  }

  /// A motion whose error adds to the errors before, as if nothing were known of them.
  [[nodiscard]] static MotionError independent(const Eigen::Matrix3d& covariance) {
    MotionError error;
    error.carried.bottomRightCorner<2, 2>().setZero();
    error.noise.topLeftCorner<3, 3>() = covariance;
    return error;
  }
};

/// Lower triangle L with L L^T = covariance, which may be singular.
[[nodiscard]] inline MotionError::Matrix root_of(const MotionError::Matrix& covariance) {
  MotionError::Matrix root = MotionError::Matrix::Zero();
  for (int j = 0; j < MotionError::kSize; ++j) {
    const double left = covariance(j, j) - root.row(j).head(j).squaredNorm();
    if (left <= 1e-18) {
      continue;
    }
    root(j, j) = std::sqrt(left);
    for (int i = j + 1; i < MotionError::kSize; ++i) {
      root(i, j) = (covariance(i, j) - root.row(i).head(j).dot(root.row(j).head(j))) / root(j, j);
    }
  }
  return root;
}

}  // namespace odoless
