#include "core/motion/motion_error.hpp"

#include <cmath>

namespace odoless {

MotionError::Matrix root_of(const MotionError::Matrix& covariance) {
  constexpr double kNothing = 1e-18;  // rounding leaves as much of a direction without noise
  MotionError::Matrix root = MotionError::Matrix::Zero();
  for (int j = 0; j < MotionError::kSize; ++j) {
    const double left = covariance(j, j) - root.row(j).head(j).squaredNorm();
    if (left <= kNothing) {
      continue;
    }
    root(j, j) = std::sqrt(left);
    for (int i = j + 1; i < MotionError::kSize; ++i) {
      root(i, j) = (covariance(i, j) - root.row(i).head(j).dot(root.row(j).head(j))) / root(j, j);
    }
  }
  return root;
}

void DrawnError::advance(const MotionError& motion, const MotionError::Matrix& noise_root, Rng& rng) {
  MotionError::Vector normals;
  for (int i = 0; i < MotionError::kSize; ++i) {
    normals(i) = rng.normal();
  }
  error_ = motion.carried * error_ + noise_root * normals;
}

}  // namespace odoless
