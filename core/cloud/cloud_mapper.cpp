#include "core/cloud/cloud_mapper.hpp"

#include <cmath>

namespace odoless {

CloudMapper::CloudMapper(const CloudParams& params, const TiltMount& mount, int beams_max)
    : params_(params), projector_(mount, beams_max), cloud_(params) {}

bool CloudMapper::key_is_due(const Pose2& odom_T_scan) const {
  return !has_key_ || odom_T_scan.distance_m(odom_T_key_) >= params_.key_distance_m ||
         std::abs(wrap_angle(odom_T_scan.yaw_rad - odom_T_key_.yaw_rad)) >= params_.key_rotation_rad;
}

void CloudMapper::add(const ScanFrame& scan, std::span<const double> tilts_rad, const ScanMotion& odom,
                      const Pose2& map_T_odom) {
  if (key_is_due(odom.target_T_first)) {
    odom_T_key_ = odom.target_T_first;
    has_key_ = true;
    cloud_.begin_key(scan.stamp_ns(), map_T_odom * odom_T_key_);
  }
  const Pose2 key_T_odom = odom_T_key_.inverse();
  const ScanMotion motion{key_T_odom * odom.target_T_first, key_T_odom * odom.target_T_last};
  for (const BeamPoint& point : projector_.project(scan, tilts_rad, motion)) {
    if (scan.range_m(point.beam) <= params_.range_max_m) {
      static_cast<void>(cloud_.add(point.x_m, point.y_m, point.z_m));
    }
  }
}

}  // namespace odoless
