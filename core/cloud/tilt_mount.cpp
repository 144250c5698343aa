#include "core/cloud/tilt_mount.hpp"

#include "core/base/check.hpp"
#include "core/math/elementary.hpp"

namespace odoless {

TiltMount::TiltMount(const TiltMountParams& params)
    : robot_T_tilt_(params.robot_T_tilt.pose()), tilt_T_laser_(params.tilt_T_laser.pose()) {
  ODOLESS_CHECK(parameters_in_range(params));
  const Pose3 level = robot_T_laser(0.0);
  robot_T_scan_ = {level.origin_m.x(), level.origin_m.y(), math::atan2(level.rotation(1, 0), level.rotation(0, 0))};
  level_height_m_ = level.origin_m.z();
}

Pose3 TiltMount::robot_T_laser(double tilt_rad) const {
  return robot_T_tilt_ * Pose3::of({}, 0.0, tilt_rad, 0.0) * tilt_T_laser_;
}

}  // namespace odoless
