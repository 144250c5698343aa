#pragma once

#include <array>

#include "firmware/threads/intake.hpp"

namespace odoless {

/// The intake of a daemon whose matcher is elsewhere: brings each motion together with its scan and hands both to the
/// filter. A motion that was lost is made up for by the next one's odom pose. One whose scan has not come waits for it
/// until the next motion, and then only composes.
///
/// Thread: sensor thread. Real time: as Intake.
class FilterIntake final : public Intake {
 public:
  FilterIntake(Pipeline& pipeline, const Clock& clock) : Intake(pipeline, clock, false, false) {}

  void on_motion(const MotionRecord& motion) override;

 private:
  void take(ScanSlot slot) override;
  [[nodiscard]] ScanSlot scan_of(std::int64_t stamp_ns);
  [[nodiscard]] OdometryStep step_of(const MotionRecord& motion) const;
  /// Hands the held motion to the filter, if there is one.
  void release();

  static constexpr std::size_t kWaiting = 4;  ///< scans whose motion has not come yet

  std::array<ScanSlot, kWaiting> waiting_{kNoSlot, kNoSlot, kNoSlot, kNoSlot};
  std::size_t next_waiting_ = 0;
  bool started_ = false;
  Pose2 odom_T_last_{};
  std::int64_t last_stamp_ns_ = 0;
  MotionMessage held_;  ///< the last motion, while its scan has not come
  bool has_held_ = false;
  MotionMessage pending_;  ///< what the filter had no room for
  bool has_pending_ = false;
};

}  // namespace odoless
