#include "tools/eval/stamp_lookup.hpp"

#include <algorithm>
#include <cmath>

namespace odoless {

StampLookup::StampLookup(std::span<const ReferencePose> poses) : sorted_(poses.begin(), poses.end()) {
  std::stable_sort(sorted_.begin(), sorted_.end(),
                   [](const ReferencePose& a, const ReferencePose& b) { return a.stamp_s < b.stamp_s; });
}

std::optional<Pose2> StampLookup::nearest(double stamp_s, double tolerance_s) const {
  const auto later =
      std::lower_bound(sorted_.begin(), sorted_.end(), stamp_s,
                       [](const ReferencePose& pose, double sought_s) { return pose.stamp_s < sought_s; });
  const ReferencePose* best = later == sorted_.end() ? nullptr : &*later;
  if (later != sorted_.begin() && (best == nullptr || stamp_s - std::prev(later)->stamp_s < best->stamp_s - stamp_s)) {
    best = &*std::prev(later);
  }
  if (best == nullptr || std::abs(best->stamp_s - stamp_s) > tolerance_s) {
    return std::nullopt;
  }
  return best->pose;
}

Pose2 robot_motion(const Pose2& laser_motion, double laser_x_m) {
  const Pose2 robot_T_laser{laser_x_m, 0.0, 0.0};
  return robot_T_laser * laser_motion * robot_T_laser.inverse();
}

}  // namespace odoless
