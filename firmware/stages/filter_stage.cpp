#include "firmware/stages/filter_stage.hpp"

#include <algorithm>
#include <cmath>

namespace odoless {
FilterStage::FilterStage(const RobotParams& params, std::uint64_t seed)
    : gate_(params.gate), filter_(params.slam, params.scan, seed), recovery_(params.recovery, params.scan, filter_) {}

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
  const Advice advice = diagnose(scan, step);
  out.found = advice == Advice::kFound;
  if (out.found) {
    restart_increment();  // the particles stand at this scan
  }
  if (!paused_ && advice != Advice::kHold && (out.found || gate_is_open())) {
    update(scan, deadline, out);
  }
  if (!recovery_.lost()) {
    filter_.work();
  }
  return placed(out, step);
}

FilterStep FilterStage::process(const OdometryStep& step) {
  compose(step);
  recovery_.move(step.previous_T_current);
  return placed({}, step);
}

Advice FilterStage::diagnose(const ScanFrame& scan, const OdometryStep& step) {
  if (!started_) {
    return Advice::kGoOn;
  }
  return recovery_.process(filter_, {.scan = scan,
                                     .update_T_scan = update_T_scan_,
                                     .previous_T_current = step.previous_T_current,
                                     .jolted = step.jolted,
                                     .matched = step.matched && (step.match.converged || !step.match.escalated),
                                     .period_s = 1e-9 * static_cast<double>(step.to_stamp_ns - step.from_stamp_ns),
                                     .escalated = step.match.escalated,
                                     .weak_information_1_m2 = step.match.weak_information_1_m2});
}

// Scans before the first one may have been lost on their way; far from the middle of the grid there is less room.
void FilterStage::begin() {
  const GridGeometry& grid = geometry();
  const double reach_m = 0.25 * grid.resolution_m * std::min(grid.columns, grid.rows);
  if (std::max(std::abs(update_T_scan_.x_m), std::abs(update_T_scan_.y_m)) < reach_m) {
    filter_.reset(update_T_scan_);
  }
  begun_ = true;
}

void FilterStage::update(const ScanFrame& scan, const Deadline& deadline, FilterStep& out) {
  if (!begun_) {
    begin();
  }
  out.report = filter_.update(increment(scan.stamp_ns()), scan, deadline);
  recovery_.note(out.report, filter_.particles());
  out.updated = true;
  started_ = true;
  update_stamp_ns_ = scan.stamp_ns();
  restart_increment();
}

void FilterStage::restart_increment() {
  update_T_scan_ = Pose2{};
  error_ = MotionError{};
}

FilterStep FilterStage::placed(FilterStep out, const OdometryStep& step) const {
  out.update_stamp_ns = update_stamp_ns_;
  out.update_T_scan = update_T_scan_;
  out.map_T_scan = filter_.estimate().map_T_scan * update_T_scan_;
  out.map_T_odom = out.map_T_scan * step.odom_T_scan.inverse();
  out.tracking = recovery_.state();
  out.fit = recovery_.fit();
  return out;
}

void FilterStage::reset(const Pose2& map_T_scan) {
  begun_ = true;
  filter_.reset(map_T_scan);
  recovery_.reset();
  restart_increment();
  started_ = false;
}

void FilterStage::set_pose(const Pose2& map_T_scan) {
  begun_ = true;
  filter_.set_pose(map_T_scan);
  recovery_.trust();
  restart_increment();
}

}  // namespace odoless
