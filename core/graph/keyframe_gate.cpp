#include "core/graph/keyframe_gate.hpp"

#include <cmath>

#include "core/math/elementary.hpp"

namespace odoless {

bool KeyframeGate::add(const Motion& motion, double unknown_s) {
  since_last_ = since_last_.then(OdometryStretch::of(motion));
  since_last_.unknown_s += unknown_s;
  odom_T_scan_ = motion.odom_T_current;
  const Pose2& way = since_last_.start_T_end;
  return !has_begun_ || since_last_.is_torn() || math::hypot(way.x_m, way.y_m) >= params_.keyframe_distance_m ||
         std::abs(way.yaw_rad) >= params_.keyframe_rotation_rad;
}

void KeyframeGate::encode(const ScanFrame& scan, const Pose2& map_T_odom, Keyframe& keyframe,
                          std::span<BeamCode> codes) const {
  odoless::encode(scan, params_.keyframe_beams_max, keyframe, codes);
  keyframe.odom_T_scan = odom_T_scan_;
  keyframe.map_T_odom = map_T_odom;
  keyframe.since_last = since_last_;
}

}  // namespace odoless
