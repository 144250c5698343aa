#include "firmware/threads/filter_intake.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace odoless {
void FilterIntake::take(ScanSlot slot) {
  if (const std::optional<ScanSlot> evicted = pipeline().scans.push(slot)) {
    give_back(*evicted);
  }
  if (has_held_ && pipeline().pool.at(slot).stamp_ns() == held_.motion.to_stamp_ns) {
    held_.slot = scan_of(held_.motion.to_stamp_ns);
    release();
  }
}

ScanSlot FilterIntake::scan_of(std::int64_t stamp_ns) {
  while (true) {
    if (oldest_waiting_ == kNoSlot) {
      oldest_waiting_ = pipeline().scans.try_pop().value_or(kNoSlot);
    }
    if (oldest_waiting_ == kNoSlot || pipeline().pool.at(oldest_waiting_).stamp_ns() > stamp_ns) {
      return kNoSlot;
    }
    const ScanSlot slot = std::exchange(oldest_waiting_, kNoSlot);
    if (pipeline().pool.at(slot).stamp_ns() == stamp_ns) {
      return slot;
    }
    give_back(slot);
  }
}

Motion FilterIntake::without_gap(const Motion& motion, MotionVerdict verdict) const {
  if (verdict == MotionVerdict::kContinues) {  // its stamps are of another clock
    const std::int64_t lost_ns = guard_.arrived_after_ns() - motion.duration_ns;
    return missing_before(motion, std::max<std::int64_t>(lost_ns, 0)).then(motion);
  }
  if (verdict == MotionVerdict::kFollows && motion.from_stamp_ns != last_stamp_ns_) {
    return missing_before(motion, motion.from_stamp_ns - last_stamp_ns_).then(motion);
  }
  Motion whole = motion;
  if (!started_) {
    whole.previous_T_current = motion.odom_T_current;  // whatever was lost before: the filter begins where odometry is
  }
  return whole;
}

// Only the sum of the lost motions is known; they are taken to be like this one, as uncertain for their time.
Motion FilterIntake::missing_before(const Motion& motion, std::int64_t duration_ns) const {
  Motion missing = motion;
  missing.from_stamp_ns = motion.from_stamp_ns - duration_ns;
  missing.to_stamp_ns = motion.from_stamp_ns;
  missing.duration_ns = duration_ns;
  missing.odom_T_current = motion.odom_T_current * motion.previous_T_current.inverse();
  missing.previous_T_current = odom_T_last_.inverse() * missing.odom_T_current;
  missing.evaluations = missing.alternative_count = 0;
  const double ratio = motion.duration_ns > 0 ? missing.duration_s() / motion.duration_s() : 0.0;
  const Eigen::Matrix3d covariance = motion.error().motion_covariance(motion.previous_T_current);
  missing.set_error(ErrorProcess::independent(missing.previous_T_current, std::abs(ratio) * covariance));
  return missing;
}

void FilterIntake::on_motion(const Motion& motion) {
  const MotionVerdict verdict = guard_.judge(motion, clock_.now_ns());
  if (verdict == MotionVerdict::kOld || verdict == MotionVerdict::kRefused) {
    return;  // of what is old, the sum is known already
  }
  release();  // the one before: its scan has been lost
  held_ = {.slot = scan_of(motion.to_stamp_ns), .motion = without_gap(motion, verdict)};
  has_held_ = true;
  held_velocity_ = std::exchange(velocity_, motion.velocity());
  started_ = true;
  odom_T_last_ = motion.odom_T_current;
  last_stamp_ns_ = motion.to_stamp_ns;
  if (held_.slot != kNoSlot) {
    release();
  }
}

void FilterIntake::release() {
  if (!std::exchange(has_held_, false)) {
    return;
  }
  MotionMessage message = held_;
  if (message.slot != kNoSlot) {
    pipeline().pool.at(message.slot).deskew(held_velocity_);
  }
  if (has_pending_) {
    if (pending_.slot != kNoSlot) {
      give_back(pending_.slot);
    }
    message.motion = pending_.motion.then(message.motion);
  }
  has_pending_ = !pipeline().motions.try_push(message);
  if (has_pending_) {
    pending_ = message;
  }
  pipeline().filter.wake.notify();
}

}  // namespace odoless
