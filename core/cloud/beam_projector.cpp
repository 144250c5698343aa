#include "core/cloud/beam_projector.hpp"

#include <cmath>

#include "core/base/check.hpp"
#include "core/geometry/interpolated.hpp"
#include "core/math/elementary.hpp"

namespace odoless {
namespace {

Eigen::Vector3d turned_about_y(const Eigen::Vector3d& p, double angle_rad) {
  const auto [s, c] = math::sincos(angle_rad);
  return {c * p.x() + s * p.z(), p.y(), c * p.z() - s * p.x()};
}

}  // namespace

BeamProjector::BeamProjector(const TiltMount& mount, int beams_max)
    : mount_(mount), scan_T_robot_(mount.robot_T_scan().inverse()), points_(static_cast<std::size_t>(beams_max)) {}

std::span<const BeamPoint> BeamProjector::project(const ScanFrame& scan, std::span<const double> tilts_rad,
                                                  const ScanMotion& motion) {
  ODOLESS_CHECK(static_cast<std::size_t>(scan.size()) <= points_.size());
  ODOLESS_CHECK(tilts_rad.size() == static_cast<std::size_t>(scan.size()));
  const Pose3& robot_T_tilt = mount_.robot_T_tilt();
  const Pose3& tilt_T_laser = mount_.tilt_T_laser();
  const Pose2 target_T_first_robot = motion.target_T_first * scan_T_robot_;
  const Pose2 target_T_last_robot = motion.target_T_last * scan_T_robot_;
  const double share_per_beam = scan.size() > 1 ? 1.0 / (scan.size() - 1) : 0.0;
  std::size_t count = 0;
  for (int i = 0; i < scan.size(); ++i) {
    const double tilt_rad = tilts_rad[static_cast<std::size_t>(i)];
    if (!scan.is_return(i) || !std::isfinite(tilt_rad)) {
      continue;
    }
    const Point2 p_laser = scan.point(i);
    const Eigen::Vector3d p_tilt =
        tilt_T_laser.rotation.leftCols<2>() * Eigen::Vector2d(p_laser.x_m, p_laser.y_m) + tilt_T_laser.origin_m;
    const Eigen::Vector3d p_robot = robot_T_tilt.rotation * turned_about_y(p_tilt, tilt_rad) + robot_T_tilt.origin_m;
    const Pose2 target_T_robot = interpolated(target_T_first_robot, target_T_last_robot, i * share_per_beam);
    const Point2 p_target = target_T_robot * Point2{p_robot.x(), p_robot.y()};
    points_[count++] = {static_cast<float>(p_target.x_m), static_cast<float>(p_target.y_m),
                        static_cast<float>(p_robot.z()), i};
  }
  return {points_.data(), count};
}

}  // namespace odoless
