#include "core/graph/odometry_stretch.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/geometry/pose2_covariance.hpp"
#include "core/graph/pose_graph.hpp"
#include "core/math/elementary.hpp"
#include "core/math/principal_axes.hpp"

namespace odoless {
namespace {

constexpr double kStanding_m = 0.005;      // a robot at rest gathers no error
constexpr double kSlip_from_m = 0.05;      // deviation of a step from which on a direction counts as unconstrained
constexpr double kSlip_share = 0.5;        // of the squared sum of slips
constexpr double kStep_share = 0.1;        // of the steps' covariances, which are for steps that err apart
constexpr double kDistance_share = 0.015;  // of the way
constexpr double kYaw_rad_per_sqrt_m = 0.25 / 57.29578 / 2.236;  // 0.25 deg after 5 m, as a random walk
constexpr double kRotation_share = 0.005;
constexpr double kDistance_min_m = 1.0;
constexpr double kCredible = 0.9;  // probability of a step below which it says nothing
constexpr double kTorn_m = 1.0;
constexpr double kTorn_rad = 0.7;

Point2 turned_back(const Point2& vector, double yaw_rad) { return Pose2{0.0, 0.0, -yaw_rad} * vector; }

Point2 slip_of(const Eigen::Matrix3d& covariance) {
  const math::PrincipalAxes<2> extent = math::principal_axes<2>(covariance.topLeftCorner<2, 2>());
  const double sd_m = std::sqrt(std::max(0.0, extent.values(1)));
  const double beyond_m = std::max(0.0, sd_m - kSlip_from_m);
  return {beyond_m * extent.axes(0, 1), beyond_m * extent.axes(1, 1)};
}

}  // namespace

OdometryStretch OdometryStretch::of(const Motion& motion) {
  OdometryStretch out;
  const Pose2& step = motion.previous_T_current;
  out.start_T_end = step;
  out.distance_m = math::hypot(step.x_m, step.y_m);
  out.rotation_rad = std::abs(step.yaw_rad);
  if (out.distance_m + 0.3 * out.rotation_rad > kStanding_m) {
    const Eigen::Matrix3d covariance = motion.error().motion_covariance(step);
    out.covariance = rows_of<3>(covariance);
    out.slip_m = slip_of(covariance);
  }
  out.map_slip = rows_of<2>(turned(matrix_of<2>(motion.map_slip), -step.yaw_rad));
  out.unknown_s = motion.probability < kCredible ? std::max(0.0, motion.duration_s()) + motion.duration_sd_s : 0.0;
  return out;
}

OdometryStretch OdometryStretch::then(const OdometryStretch& next) const {
  OdometryStretch out;
  out.start_T_end = start_T_end * next.start_T_end;
  out.covariance = rows_of<3>(carried(matrix_of<3>(covariance), next.start_T_end) + matrix_of<3>(next.covariance));
  const Point2 before_m = turned_back(slip_m, next.start_T_end.yaw_rad);
  const double sign = before_m.x_m * next.slip_m.x_m + before_m.y_m * next.slip_m.y_m < 0.0 ? -1.0 : 1.0;
  out.slip_m = {before_m.x_m + sign * next.slip_m.x_m, before_m.y_m + sign * next.slip_m.y_m};
  out.map_slip = rows_of<2>(
      Eigen::Matrix2d(turned(matrix_of<2>(map_slip), -next.start_T_end.yaw_rad) + matrix_of<2>(next.map_slip)));
  out.distance_m = distance_m + next.distance_m;
  out.rotation_rad = rotation_rad + next.rotation_rad;
  out.unknown_s = unknown_s + next.unknown_s;
  return out;
}

Eigen::Matrix3d OdometryStretch::constraint_covariance(const RobotLimits& limits) const {
  const Eigen::Vector2d slip(slip_m.x_m, slip_m.y_m);
  Eigen::Matrix3d out = kStep_share * matrix_of<3>(covariance);
  out.topLeftCorner<2, 2>() += kSlip_share * slip * slip.transpose();
  const double sd_m = kDistance_share * std::max(kDistance_min_m, distance_m);
  const double sd_rad = kYaw_rad_per_sqrt_m * std::sqrt(std::max(0.5, distance_m)) + kRotation_share * rotation_rad;
  out.diagonal() += Eigen::Vector3d(sd_m * sd_m, sd_m * sd_m, sd_rad * sd_rad);
  if (is_torn()) {
    const double torn_m = std::max(kTorn_m, 0.5 * limits.speed_max_mps * unknown_s);
    const double torn_rad = std::clamp(0.5 * limits.turn_rate_max_radps * unknown_s, kTorn_rad, 0.5 * std::numbers::pi);
    out.diagonal() += Eigen::Vector3d(torn_m * torn_m, torn_m * torn_m, torn_rad * torn_rad);
  }
  return out;
}

}  // namespace odoless
