#pragma once

#include "core/geometry/pose2.hpp"

namespace odoless {

/// On the way from `first` (share 0) to `last` (share 1), place and angle evenly, the angle the short way round.
[[nodiscard]] inline Pose2 interpolated(const Pose2& first, const Pose2& last, double share) {
  return {first.x_m + share * (last.x_m - first.x_m), first.y_m + share * (last.y_m - first.y_m),
          wrap_angle(first.yaw_rad + share * wrap_angle(last.yaw_rad - first.yaw_rad))};
}

/// The same as a type, for StampedHistory.
struct BetweenPoses {
  Pose2 operator()(const Pose2& before, const Pose2& after, double share) const {
    return interpolated(before, after, share);
  }
};

}  // namespace odoless
