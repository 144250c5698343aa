#include "tools/eval/pose_errors.hpp"

#include <cmath>

namespace odoless {

PoseError pose_error(const Pose2& reference, const Pose2& estimate) {
  const Pose2 difference = reference.inverse() * estimate;
  return {std::hypot(difference.x_m, difference.y_m), std::abs(difference.yaw_rad)};
}

PoseErrorStatistics summarise(const std::vector<PoseError>& errors) {
  std::vector<double> translations_m;
  std::vector<double> rotations_rad;
  for (const PoseError& error : errors) {
    translations_m.push_back(error.translation_m);
    rotations_rad.push_back(error.rotation_rad);
  }
  return {summarise(std::move(translations_m)), summarise(std::move(rotations_rad))};
}

}  // namespace odoless
