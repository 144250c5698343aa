#include <cmath>

#include "core/math/elementary.hpp"
#include "core/slam/lslam.hpp"

namespace odoless {
PoseEstimate Lslam::estimate() const {
  double x_m = 0.0;
  double y_m = 0.0;
  double sine = 0.0;
  double cosine = 0.0;
  for (int i = 0; i < particles(); ++i) {
    x_m += weight(i) * pose(i).x_m;
    y_m += weight(i) * pose(i).y_m;
    sine += weight(i) * math::sin(pose(i).yaw_rad);
    cosine += weight(i) * math::cos(pose(i).yaw_rad);
  }
  PoseEstimate estimate{.map_T_scan = {x_m, y_m, math::atan2(sine, cosine)}, .agreement = 0.0};
  for (int i = 0; i < particles(); ++i) {
    const Pose2& p = pose(i);
    const Eigen::Vector3d error{p.x_m - x_m, p.y_m - y_m, wrap_angle(p.yaw_rad - estimate.map_T_scan.yaw_rad)};
    estimate.covariance += weight(i) * error * error.transpose();
    const bool is_near =
        math::hypot(error.x(), error.y()) <= PoseEstimate::kOk_m && std::abs(error.z()) <= PoseEstimate::kOk_rad;
    estimate.agreement += is_near ? weight(i) : 0.0;
  }
  return estimate;
}

}  // namespace odoless
