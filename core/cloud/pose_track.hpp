#pragma once

#include <cstddef>
#include <cstdint>

#include "core/base/result.hpp"
#include "core/base/stamped_history.hpp"
#include "core/geometry/interpolated.hpp"

namespace odoless {

/// The poses of the level scans, for the pose at any moment between: even motion from one to the next.
///
/// Where a nodding laser begins to turn between two level passes, the motion was not even. The turn rate of the
/// intervals before and after shows it: where theirs could put the yaw wrong by more than that, no pose is known.
///
/// Thread:    one thread. Real time: as StampedHistory.
class PoseTrack {
 public:
  /// @param gap_max_ns        Between poses farther apart nothing is known.
  /// @param yaw_doubt_max_rad  Nor where the yaw may be off by more than twice this.
  PoseTrack(std::size_t capacity, std::int64_t gap_max_ns, double yaw_doubt_max_rad)
      : poses_(capacity, gap_max_ns), yaw_doubt_max_rad_(yaw_doubt_max_rad) {}

  /// False, and nothing added, where the stamp is not later than the last one's.
  bool add(std::int64_t stamp_ns, const Pose2& odom_T_scan) { return poses_.add(stamp_ns, odom_T_scan); }

  /// Errc::kNotYet, kTooOld, kGap as StampedHistory::at; kNotYet too until the pose after the next one is there, and
  /// kGap where the yaw is in doubt.
  [[nodiscard]] Result<Pose2> at(std::int64_t stamp_ns) const;

 private:
  using Poses = StampedHistory<Pose2, BetweenPoses>;

  /// Mean turn rate from the i-th pose to the next.
  [[nodiscard]] double turn_rate_radps(std::size_t i) const;

  Poses poses_;
  double yaw_doubt_max_rad_;
};

}  // namespace odoless
