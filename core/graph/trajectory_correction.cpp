#include "core/graph/trajectory_correction.hpp"

#include <cmath>

namespace odoless {

void TrajectoryCorrection::add(const SubmapPlace& submap) {
  place_at_ns_.emplace(submap.origin_stamp_ns, places_.size());
  places_.push_back(submap);
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
    const auto found = place_at_ns_.find(pose.stamp_ns);
    if (found != place_at_ns_.end() && (anchors_.empty() || found->second > anchors_.back().place)) {
      anchors_.push_back({found->second, pose.stamp_ns, travel_m});
    }
  }
}

Pose2 TrajectoryCorrection::seen_from(const Anchor& anchor, const Pose2& odom_T_scan) const {
  const SubmapPlace& place = places_[anchor.place];
  return place.map_T_submap * (place.odom_T_submap.inverse() * odom_T_scan);
}

void TrajectoryCorrection::correct(std::span<StampedPose> poses) {
  if (places_.empty()) {
    return;
  }
  if (anchors_.empty()) {
    anchors_.push_back({});
  }
  for (StampedPose& pose : poses) {
    const double travel_m = travel_.to(pose.map_T_scan);
    if (passed_ < anchors_.size() && pose.stamp_ns == anchors_[passed_].stamp_ns) {
      ++passed_;
    }
    const Anchor& last = anchors_[passed_ == 0 ? 0 : passed_ - 1];
    const Anchor& next = anchors_[passed_ < anchors_.size() ? passed_ : passed_ - 1];
    const double way_m = next.travel_m - last.travel_m;
    const double share = way_m > 0.0 ? (travel_m - last.travel_m) / way_m : 0.0;
    const Pose2 before = seen_from(last, pose.map_T_scan);
    const Pose2 after = seen_from(next, pose.map_T_scan);
    pose.map_T_scan = {before.x_m + share * (after.x_m - before.x_m), before.y_m + share * (after.y_m - before.y_m),
                       wrap_angle(before.yaw_rad + share * wrap_angle(after.yaw_rad - before.yaw_rad))};
  }
}

}  // namespace odoless
