#pragma once

#include <optional>
#include <span>
#include <vector>

#include "tools/log/reference_poses.hpp"

namespace odoless {

/// How an estimate and its reference are brought together.
struct Association {
  double tolerance_s = 0.01;  ///< stamps further apart do not belong together
  double laser_x_m = 0.0;     ///< the laser's place before the point of the robot that the reference tells
};

/// Finds poses by their stamps, whatever their order.
class StampLookup {
 public:
  explicit StampLookup(std::span<const ReferencePose> poses);

  /// The pose nearest in time; nothing when none is within `tolerance_s`.
  [[nodiscard]] std::optional<Pose2> nearest(double stamp_s, double tolerance_s) const;

 private:
  std::vector<ReferencePose> sorted_;
};

/// A motion of the laser as the robot's point `laser_x_m` behind it makes it.
[[nodiscard]] Pose2 robot_motion(const Pose2& laser_motion, double laser_x_m);

}  // namespace odoless
