#include "firmware/stages/filter_stage.hpp"

#include <cmath>

namespace odoless {

FilterStage::FilterStage(const RobotParams& params, std::uint64_t seed)
    : gate_(params.gate), filter_(params.slam, params.scan, seed) {}

bool FilterStage::gate_is_open() const {
  return !started_ || std::hypot(update_T_scan_.x_m, update_T_scan_.y_m) >= gate_.distance_m ||
         std::abs(update_T_scan_.yaw_rad) >= gate_.rotation_rad;
}

void FilterStage::compose(const OdometryStep& step) {
  error_ = error_.then(step.error);
  update_T_scan_ = update_T_scan_ * step.previous_T_current;
}

MotionIncrement FilterStage::increment(std::int64_t stamp_ns) const {
  return {update_stamp_ns_, stamp_ns, update_T_scan_, gate_.widen_by_match ? error_ : MotionError{}};
}

FilterStep FilterStage::process(const ScanFrame& scan, const OdometryStep& step, const Deadline& deadline) {
  compose(step);
  FilterStep out;
  if (!paused_ && gate_is_open()) {
    out.report = filter_.update(increment(scan.stamp_ns()), scan, deadline);
    out.updated = true;
    started_ = true;
    update_stamp_ns_ = scan.stamp_ns();
    update_T_scan_ = Pose2{};
    error_ = MotionError{};
  }
  filter_.work();
  return placed(out, step);
}

FilterStep FilterStage::process(const OdometryStep& step) {
  compose(step);
  return placed({}, step);
}

FilterStep FilterStage::placed(FilterStep out, const OdometryStep& step) const {
  out.update_stamp_ns = update_stamp_ns_;
  out.update_T_scan = update_T_scan_;
  out.map_T_scan = filter_.estimate().map_T_scan * update_T_scan_;
  out.map_T_odom = out.map_T_scan * step.odom_T_scan.inverse();
  return out;
}

void FilterStage::reset(const Pose2& map_T_scan) {
  filter_.reset(map_T_scan);
  update_T_scan_ = Pose2{};
  error_ = MotionError{};
  started_ = false;
}

void FilterStage::set_pose(const Pose2& map_T_scan) {
  filter_.set_pose(map_T_scan);
  update_T_scan_ = Pose2{};
  error_ = MotionError{};
}

}  // namespace odoless
