#pragma once

#include <Eigen/Core>
#include <cmath>

#include "core/geometry/pose2.hpp"
#include "core/math/elementary.hpp"

namespace odoless {

/// How small errors of poses, over (x_m, y_m, yaw_rad), go from frame to frame: the one place for it.

/// Takes errors in axes that are turned by `yaw_rad` to those that they are turned against.
[[nodiscard]] inline Eigen::Matrix3d turn_matrix(double yaw_rad) {
  const auto [s, c] = math::sincos(yaw_rad);
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  turn.topLeftCorner<2, 2>() << c, -s, s, c;
  return turn;
}

/// The covariance in axes that the old ones are turned against by `yaw_rad`.
[[nodiscard]] inline Eigen::Matrix3d turned(const Eigen::Matrix3d& covariance, double yaw_rad) {
  const Eigen::Matrix3d turn = turn_matrix(yaw_rad);
  return turn * covariance * turn.transpose();
}

/// The same of x_m and y_m alone.
[[nodiscard]] inline Eigen::Matrix2d turned(const Eigen::Matrix2d& covariance, double yaw_rad) {
  const Eigen::Matrix2d turn = turn_matrix(yaw_rad).topLeftCorner<2, 2>();
  return turn * covariance * turn.transpose();
}

/// What an error of a_T_b, in the axes of a, makes of a_T_c: its yaw turns the way from b to c.
[[nodiscard]] inline Eigen::Matrix3d lever_matrix(const Pose2& a_T_b, const Pose2& a_T_c) {
  Eigen::Matrix3d lever = Eigen::Matrix3d::Identity();
  lever(0, 2) = a_T_b.y_m - a_T_c.y_m;
  lever(1, 2) = a_T_c.x_m - a_T_b.x_m;
  return lever;
}

/// The adjoint of SE(2): a small motion e of b, in the axes of b, is adjoint(a_T_b) * e in those of a, for
/// a_T_b * e = (adjoint(a_T_b) * e) * a_T_b.
[[nodiscard]] inline Eigen::Matrix3d adjoint(const Pose2& a_T_b) {
  Eigen::Matrix3d matrix = turn_matrix(a_T_b.yaw_rad);
  matrix(0, 2) = a_T_b.y_m;
  matrix(1, 2) = -a_T_b.x_m;
  return matrix;
}

/// Covariance of a_T_b * b_T_c whose errors are independent; each in the axes of the frame that it begins at.
[[nodiscard]] inline Eigen::Matrix3d composed_covariance(const Pose2& a_T_b, const Eigen::Matrix3d& covariance_ab,
                                                         const Pose2& b_T_c, const Eigen::Matrix3d& covariance_bc) {
  const Eigen::Matrix3d lever = lever_matrix(a_T_b, a_T_b * b_T_c);
  return lever * covariance_ab * lever.transpose() + turned(covariance_bc, a_T_b.yaw_rad);
}

/// Probability that an error of such a covariance is within so far and such an angle. Along the axis of the largest
/// deviation alone: the others are mostly much smaller.
[[nodiscard]] inline double probability_within(const Eigen::Matrix3d& covariance, double distance_m, double angle_rad) {
  const double middle_m2 = 0.5 * (covariance(0, 0) + covariance(1, 1));
  const double half_m2 = math::hypot(0.5 * (covariance(0, 0) - covariance(1, 1)), covariance(0, 1));
  const auto inside = [](double bound, double variance) {
    return variance > 0.0 ? math::erf(bound / std::sqrt(2.0 * variance)) : 1.0;
  };
  return inside(distance_m, middle_m2 + half_m2) * inside(angle_rad, covariance(2, 2));
}

}  // namespace odoless
