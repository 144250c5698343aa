#pragma once

#include <Eigen/Core>

#include "core/base/rng.hpp"
#include "core/geometry/pose2.hpp"

namespace odoless {

/// How the error of laser odometry goes on over a motion: a linear process, which tells more than one covariance.
///
/// The error is (x_m, y_m, yaw_rad, vx_mps, vy_mps): true pose = tracked pose * (x_m, y_m, yaw_rad), true speed =
/// tracked speed + (vx_mps, vy_mps), both in the axes of the scan. Over a motion it becomes transition * error + noise
/// (F and Q of a Kalman filter). So an error that the scene mends goes away, and one of the speed along a featureless
/// wall grows from motion to motion instead of cancelling out.
struct ErrorProcess {
  static constexpr int kSize = 5;
  using Vector = Eigen::Matrix<double, kSize, 1>;
  using Matrix = Eigen::Matrix<double, kSize, kSize>;

  Matrix initial = Matrix::Zero();  ///< covariance of the error before the motion
  Matrix transition = Matrix::Identity();
  Matrix noise = Matrix::Zero();  ///< covariance of what is added

  /// Covariance of the error after the motion, where before it was `before`.
  [[nodiscard]] Matrix after(const Matrix& before) const {
    return transition * before * transition.transpose() + noise;
  }

  /// The process of this motion followed by the next.
  [[nodiscard]] ErrorProcess then(const ErrorProcess& next) const {
    return {initial, next.transition * transition, next.transition * noise * next.transition.transpose() + next.noise};
  }

  /// Covariance of the motion itself over (x_m, y_m, yaw_rad), in the axes of the scan that it ends at: of what the
  /// error gained or lost, whatever the pose before was off by.
  [[nodiscard]] Eigen::Matrix3d motion_covariance(const Pose2& previous_T_current) const;

  /// Of a motion whose error has nothing to do with the errors before.
  /// @param covariance  Over (x_m, y_m, yaw_rad), in the axes of the scan that it ends at.
  [[nodiscard]] static ErrorProcess independent(const Pose2& previous_T_current, const Eigen::Matrix3d& covariance);
};

/// Lower triangle L with L L^T = covariance, which may be singular.
[[nodiscard]] ErrorProcess::Matrix root_of(const ErrorProcess::Matrix& covariance);

/// What a particle takes the tracker to be off by.
///
/// Thread: owned by one thread. Real time: no allocation.
class DrawnError {
 public:
  /// Goes on over a motion, with `noise_root` that of its noise: five normal numbers.
  void advance(const ErrorProcess& process, const ErrorProcess::Matrix& noise_root, Rng& rng);
  /// tracked_T_true.
  [[nodiscard]] Pose2 pose() const { return {error_(0), error_(1), error_(2)}; }

 private:
  ErrorProcess::Vector error_ = ErrorProcess::Vector::Zero();
};

}  // namespace odoless
