#pragma once

#include "firmware/stages/motion_guard.hpp"
#include "firmware/threads/intake.hpp"

namespace odoless {

/// The intake of a daemon whose matcher is elsewhere: brings each motion together with its scan and hands both to the
/// filter. A motion that was lost is made up for by the next one's odom pose. One whose scan has not come waits for it
/// until the next motion, and then only composes. Scans wait for their motions in the queue of scans, as long as one
/// that waits for a matcher. What is no motion of this robot, or none of now, is refused (MotionGuard).
/// A scan is deskewed with the speed of the motion before; a better one that the matcher may have found does not come
/// along.
///
/// Thread: sensor thread. Real time: as Intake.
class FilterIntake final : public Intake {
 public:
  FilterIntake(Pipeline& pipeline, const Clock& clock, const LaserMountParams& mount, const RobotLimits& limits)
      : Intake(pipeline, clock, mount, false, false), clock_(clock), guard_(limits) {}

  void on_motion(const Motion& motion) override;

 private:
  void take(ScanSlot slot) override;
  void add_counts(SourceHealth& health) const override { health.motions_refused += guard_.refused(); }
  /// The waiting scan of this stamp; older ones go, for their motions have been lost.
  [[nodiscard]] ScanSlot scan_of(std::int64_t stamp_ns);
  /// With all that was lost between the last motion and this one.
  [[nodiscard]] Motion without_gap(const Motion& motion, MotionVerdict verdict) const;
  /// What was lost in that time.
  [[nodiscard]] Motion missing_before(const Motion& motion, std::int64_t duration_ns) const;
  /// Hands the held motion to the filter, if there is one.
  void release();

  const Clock& clock_;
  MotionGuard guard_;
  ScanSlot oldest_waiting_ = kNoSlot;  ///< taken from the queue of scans, but its motion has not come yet
  bool started_ = false;
  Pose2 odom_T_last_{};
  std::int64_t last_stamp_ns_ = 0;
  MotionMessage held_;  ///< the last motion, while its scan has not come
  bool has_held_ = false;
  Velocity2 velocity_;       ///< of the last motion
  Velocity2 held_velocity_;  ///< of the one before it
  MotionMessage pending_;    ///< what the filter had no room for
  bool has_pending_ = false;
};

}  // namespace odoless
