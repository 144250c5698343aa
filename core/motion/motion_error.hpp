#pragma once

#include <Eigen/Core>

#include "core/base/rng.hpp"
#include "core/geometry/pose2.hpp"

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
[[nodiscard]] MotionError::Matrix root_of(const MotionError::Matrix& covariance);

/// What a particle takes the tracker to be off by.
///
/// Thread: owned by one thread. Real time: no allocation.
class DrawnError {
 public:
  /// Goes on over a motion, with `noise_root` that of its noise: five normal numbers.
  void advance(const MotionError& motion, const MotionError::Matrix& noise_root, Rng& rng);
  /// tracked_T_true.
  [[nodiscard]] Pose2 pose() const { return {error_(0), error_(1), error_(2)}; }

 private:
  MotionError::Vector error_ = MotionError::Vector::Zero();
};

}  // namespace odoless
