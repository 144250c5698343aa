#include "firmware/threads/filter_intake.hpp"

#include <cmath>
#include <optional>
#include <utility>

#include "firmware/records/convert.hpp"
#include "firmware/threads/matcher_loop.hpp"

namespace odoless {
namespace {

// The motion's covariance in the axes of the scan that it ends at: all that is known of the error over a gap.
Eigen::Matrix3d in_current_axes(const OdometryStep& step) {
  const double c = std::cos(step.previous_T_current.yaw_rad);
  const double s = std::sin(step.previous_T_current.yaw_rad);
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  turn.topLeftCorner<2, 2>() << c, s, -s, c;
  return turn * step.covariance * turn.transpose();
}

}  // namespace

void FilterIntake::take(ScanSlot slot) {
  if (const std::optional<ScanSlot> evicted = pipeline().scans.push(slot)) {
    give_back(*evicted);
  }
  if (has_held_ && pipeline().pool.at(slot).stamp_ns() == held_.step.to_stamp_ns) {
    held_.slot = scan_of(held_.step.to_stamp_ns);
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

OdometryStep FilterIntake::step_of(const MotionRecord& motion) const {
  OdometryStep step = to_step(motion);
  if (!started_) {
    step.previous_T_current = motion.odom_T_scan;  // whatever was lost before: the filter begins where the odometry is
  } else if (motion.from_stamp_ns != last_stamp_ns_) {
    // Of the motions in between only the sum is known; their deviations are taken to be like this one's.
    const auto whole_s = static_cast<double>(motion.to_stamp_ns - last_stamp_ns_);
    const auto own_s = static_cast<double>(motion.to_stamp_ns - motion.from_stamp_ns);
    step.from_stamp_ns = last_stamp_ns_;
    step.previous_T_current = odom_T_last_.inverse() * motion.odom_T_scan;
    step.covariance *= own_s > 0.0 ? whole_s / own_s : 1.0;
    step.error = MotionError::independent(in_current_axes(step));
  }
  return step;
}

void FilterIntake::on_motion(const MotionRecord& motion) {
  if (started_ && motion.to_stamp_ns <= last_stamp_ns_) {
    return;  // came twice, or too late: the sum is known already
  }
  release();  // the one before: its scan has been lost
  held_ = {.slot = scan_of(motion.to_stamp_ns), .step = step_of(motion)};
  has_held_ = true;
  started_ = true;
  odom_T_last_ = motion.odom_T_scan;
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
  if (has_pending_) {
    if (pending_.slot != kNoSlot) {
      give_back(pending_.slot);
    }
    message.step = compose(pending_.step, message.step);
  }
  has_pending_ = !pipeline().motions.try_push(message);
  if (has_pending_) {
    pending_ = message;
  }
  pipeline().filter.wake.notify();
}

}  // namespace odoless
