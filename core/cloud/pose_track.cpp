#include "core/cloud/pose_track.hpp"

#include <algorithm>
#include <cmath>

namespace odoless {
namespace {

double seconds(std::int64_t time_ns) { return static_cast<double>(time_ns) * 1e-9; }

}  // namespace

double PoseTrack::turn_rate_radps(std::size_t i) const {
  const Poses::Sample& from = poses_.sample(i);
  const Poses::Sample& to = poses_.sample(i + 1);
  return wrap_angle(to.value.yaw_rad - from.value.yaw_rad) / seconds(to.stamp_ns - from.stamp_ns);
}

// Where a turn begins within an interval T, its rate differs by w or more from one neighbour's, and even motion puts
// the yaw off by w T / 2 at most: twice the doubt. Halfway through, where most scans are, it is w T / 4.
Result<Pose2> PoseTrack::at(std::int64_t stamp_ns) const {
  Result<Pose2> pose = poses_.at(stamp_ns);
  if (!pose.ok()) {
    return pose;
  }
  const std::size_t before = poses_.last_not_later(stamp_ns);
  if (poses_.sample(before).stamp_ns == stamp_ns || poses_.sample(before + 1).stamp_ns == stamp_ns) {
    return pose;
  }
  if (before + 2 >= poses_.size()) {
    return Errc::kNotYet;
  }
  const double here_radps = turn_rate_radps(before);
  const double earlier_radps = before > 0 ? turn_rate_radps(before - 1) : here_radps;
  const double change_radps =
      std::max(std::abs(turn_rate_radps(before + 1) - here_radps), std::abs(earlier_radps - here_radps));
  const double lasts_s = seconds(poses_.sample(before + 1).stamp_ns - poses_.sample(before).stamp_ns);
  return change_radps * lasts_s / 4.0 > yaw_doubt_max_rad_ ? Result<Pose2>(Errc::kGap) : pose;
}

}  // namespace odoless
