#include <cmath>
#include <numbers>

#include "core/slam/lslam.hpp"

namespace odoless {
namespace {

constexpr double kOk_m = 0.5;  // what OK promises
constexpr double kOk_rad = 5.0 * std::numbers::pi / 180.0;

}  // namespace

PoseEstimate Lslam::estimate() const {
  double x_m = 0.0;
  double y_m = 0.0;
  double sine = 0.0;
  double cosine = 0.0;
  for (int i = 0; i < particles(); ++i) {
    x_m += weight(i) * pose(i).x_m;
    y_m += weight(i) * pose(i).y_m;
    sine += weight(i) * std::sin(pose(i).yaw_rad);
    cosine += weight(i) * std::cos(pose(i).yaw_rad);
  }
  PoseEstimate estimate{.map_T_scan = {x_m, y_m, std::atan2(sine, cosine)}, .agreement = 0.0};
  for (int i = 0; i < particles(); ++i) {
    const Pose2& p = pose(i);
    const Eigen::Vector3d error{p.x_m - x_m, p.y_m - y_m, wrap_angle(p.yaw_rad - estimate.map_T_scan.yaw_rad)};
    estimate.covariance += weight(i) * error * error.transpose();
    const bool is_near = std::hypot(error.x(), error.y()) <= kOk_m && std::abs(error.z()) <= kOk_rad;
    estimate.agreement += is_near ? weight(i) : 0.0;
  }
  return estimate;
}

}  // namespace odoless
