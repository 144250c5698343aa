#pragma once

#include "firmware/threads/intake.hpp"

namespace odoless {

/// The intake of a daemon whose matcher is elsewhere: brings each motion together with its scan and hands both to the
/// filter. A motion that was lost is made up for by the next one's odom pose. One whose scan has not come waits for it
/// until the next motion, and then only composes. Scans wait for their motions in the queue of scans, as long as one
/// that waits for a matcher.
///
/// Thread: sensor thread. Real time: as Intake.
class FilterIntake final : public Intake {
 public:
  FilterIntake(Pipeline& pipeline, const Clock& clock) : Intake(pipeline, clock, false, false) {}

  void on_motion(const Motion& motion) override;

 private:
  void take(ScanSlot slot) override;
  /// The waiting scan of this stamp; older ones go, for their motions have been lost.
  [[nodiscard]] ScanSlot scan_of(std::int64_t stamp_ns);
  /// With all that was lost between the last motion and this one.
  [[nodiscard]] Motion without_gap(const Motion& motion) const;
  [[nodiscard]] Motion missing_before(const Motion& motion) const;
  /// Hands the held motion to the filter, if there is one.
  void release();

  ScanSlot oldest_waiting_ = kNoSlot;  ///< taken from the queue of scans, but its motion has not come yet
  bool started_ = false;
  Pose2 odom_T_last_{};
  std::int64_t last_stamp_ns_ = 0;
  MotionMessage held_;  ///< the last motion, while its scan has not come
  bool has_held_ = false;
  MotionMessage pending_;  ///< what the filter had no room for
  bool has_pending_ = false;
};

}  // namespace odoless
