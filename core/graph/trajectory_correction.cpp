#include "core/graph/trajectory_correction.hpp"

#include <cmath>

namespace odoless {

TrajectoryCorrection::TrajectoryCorrection(std::span<const Submap> submaps, const PoseGraph& graph) {
  for (std::size_t i = 0; i < submaps.size(); ++i) {
    places_.push_back({.origin_stamp_ns = submaps[i].origin_stamp_ns,
                       .odom_T_submap = submaps[i].odom_T_submap,
                       .map_T_submap = graph.pose(static_cast<int>(i))});
  }
}

double TrajectoryCorrection::Travel::to(const Pose2& odom_T_scan) {
  constexpr double kLever_m = 0.3;
  if (has_begun_) {
    const Pose2 step = before_.inverse() * odom_T_scan;
    travel_m_ = travel_m_ + step.distance_m({}) + kLever_m * std::abs(step.yaw_rad);
  }
  has_begun_ = true;
  before_ = odom_T_scan;
  return travel_m_;
}

void TrajectoryCorrection::survey(std::span<const StampedPose> odom) {
  for (const StampedPose& pose : odom) {
    const double travel_m = survey_.to(pose.map_T_scan);
    while (surveyed_ < places_.size() && pose.stamp_ns == places_[surveyed_].origin_stamp_ns) {
      places_[surveyed_++].travel_m = travel_m;
    }
  }
}

Pose2 TrajectoryCorrection::seen_from(std::size_t place, const Pose2& odom_T_scan) const {
  return places_[place].map_T_submap * (places_[place].odom_T_submap.inverse() * odom_T_scan);
}

void TrajectoryCorrection::correct(std::span<StampedPose> poses) {
  if (places_.empty()) {
    return;
  }
  for (StampedPose& pose : poses) {
    const double travel_m = travel_.to(pose.map_T_scan);
    while (at_ + 1 < places_.size() && pose.stamp_ns == places_[at_ + 1].origin_stamp_ns) {
      ++at_;
    }
    const Pose2 odom_T_scan = pose.map_T_scan;
    const Pose2 before = seen_from(at_, odom_T_scan);
    pose.map_T_scan = before;
    const bool lies_between = at_ > 0 && at_ + 1 < surveyed_ && places_[at_ + 1].travel_m > places_[at_].travel_m;
    if (lies_between) {
      const Pose2 after = seen_from(at_ + 1, odom_T_scan);
      const double share = (travel_m - places_[at_].travel_m) / (places_[at_ + 1].travel_m - places_[at_].travel_m);
      pose.map_T_scan = {before.x_m + share * (after.x_m - before.x_m), before.y_m + share * (after.y_m - before.y_m),
                         wrap_angle(before.yaw_rad + share * wrap_angle(after.yaw_rad - before.yaw_rad))};
    }
  }
}

}  // namespace odoless
