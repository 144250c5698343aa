#include "core/motion/error_process.hpp"

#include <cmath>

#include "core/geometry/pose2_covariance.hpp"

namespace odoless {

Eigen::Matrix3d ErrorProcess::motion_covariance(const Pose2& previous_T_current) const {
  Eigen::Matrix<double, 3, kSize> gained = transition.topRows<3>();
  gained.leftCols<3>() -= adjoint(previous_T_current.inverse());
  return gained * initial * gained.transpose() + noise.topLeftCorner<3, 3>();
}

ErrorProcess ErrorProcess::independent(const Pose2& previous_T_current, const Eigen::Matrix3d& covariance) {
  ErrorProcess process;
  process.transition.setZero();
  process.transition.topLeftCorner<3, 3>() = adjoint(previous_T_current.inverse());
  process.noise.topLeftCorner<3, 3>() = covariance;
  return process;
}

ErrorProcess::Matrix root_of(const ErrorProcess::Matrix& covariance) {
  constexpr double kNothing = 1e-18;  // rounding leaves as much of a direction without noise
  ErrorProcess::Matrix root = ErrorProcess::Matrix::Zero();
  for (int j = 0; j < ErrorProcess::kSize; ++j) {
    const double left = covariance(j, j) - root.row(j).head(j).squaredNorm();
    if (left <= kNothing) {
      continue;
    }
    root(j, j) = std::sqrt(left);
    for (int i = j + 1; i < ErrorProcess::kSize; ++i) {
      root(i, j) = (covariance(i, j) - root.row(i).head(j).dot(root.row(j).head(j))) / root(j, j);
    }
  }
  return root;
}

void DrawnError::advance(const ErrorProcess& process, const ErrorProcess::Matrix& noise_root, Rng& rng) {
  ErrorProcess::Vector normals;
  for (int i = 0; i < ErrorProcess::kSize; ++i) {
    normals(i) = rng.normal();
  }
  error_ = process.transition * error_ + noise_root * normals;
}

}  // namespace odoless
