#include "firmware/stages/filter_stage.hpp"

#include <algorithm>
#include <cmath>

#include "core/geometry/pose2_covariance.hpp"
#include "core/math/elementary.hpp"

namespace odoless {
namespace {

constexpr double kJump_m = 0.5;  // from where the motion leads
constexpr double kJump_rad = 0.1;

double within_ok(const Motion& motion) {
  return probability_within(motion.covariance(), PoseEstimate::kOk_m, PoseEstimate::kOk_rad);
}

}  // namespace

FilterStage::FilterStage(const RobotParams& params, std::uint64_t seed)
    : gate_(params.gate),
      laser_(LaserPlace::of(params.mount)),
      filter_(params.slam, params.scan, seed),
      recovery_(params.recovery, params.scan, filter_),
      is_in_graph_(params.graph.enabled) {}

bool FilterStage::gate_is_open() const {
  const Pose2& update_T_scan = since_update_.previous_T_current;
  return !started_ || math::hypot(update_T_scan.x_m, update_T_scan.y_m) >= gate_.distance_m ||
         std::abs(update_T_scan.yaw_rad) >= gate_.rotation_rad;
}

void FilterStage::compose(const Motion& motion) {
  since_update_ = since_update_.then(motion);
  since_scan_ = since_scan_.then(motion);
}

FilterStep FilterStage::process(const ScanFrame& scan, const Motion& motion, const Deadline& deadline) {
  compose(motion);
  FilterStep out;
  const Advice advice = diagnose(scan);
  out.unknown_s = recovery_.unknown_s();
  since_scan_ = Motion{};
  out.found = advice == Advice::kFound;
  if (out.found) {
    restart(scan.stamp_ns());
  }
  if (!paused_ && advice != Advice::kHold && (out.found || gate_is_open())) {
    update(scan, deadline, out);
  }
  if (!recovery_.lost()) {
    filter_.work();
  }
  return placed(out, motion);
}

FilterStep FilterStage::process(const Motion& motion) {
  compose(motion);
  return placed({}, motion);
}

Advice FilterStage::diagnose(const ScanFrame& scan) {
  if (!started_) {
    return Advice::kGoOn;
  }
  return recovery_.process(filter_,
                           {.scan = scan, .update_T_scan = since_update_.previous_T_current, .motion = since_scan_});
}

// Scans before the first one may have been lost on their way.
void FilterStage::begin() {
  filter_.reset(since_update_.previous_T_current);
  begun_ = true;
}

void FilterStage::update(const ScanFrame& scan, const Deadline& deadline, FilterStep& out) {
  if (!begun_) {
    begin();
  }
  if (!gate_.widen_by_match) {
    since_update_.set_error({});
  }
  const std::optional<Pose2> expected =
      recovery_.may_be_elsewhere() ? std::optional(filter_.estimate().map_T_scan * since_update_.previous_T_current)
                                   : std::nullopt;
  out.report = filter_.update(since_update_, scan, deadline);
  if (expected && !are_within(*expected, filter_.estimate().map_T_scan, kJump_m, kJump_rad)) {
    ++placements_;
  }
  recovery_.note_update(within_ok(since_update_));
  out.updated = true;
  started_ = true;
  update_stamp_ns_ = scan.stamp_ns();
  since_update_ = Motion{};
}

void FilterStage::restart(std::int64_t stamp_ns) {
  since_update_ = Motion::between(update_stamp_ns_, stamp_ns, {});
  ++placements_;
}

FilterStep FilterStage::placed(FilterStep out, const Motion& motion) const {
  out.placements = placements_;
  out.update_stamp_ns = update_stamp_ns_;
  out.update_T_scan = since_update_.previous_T_current;
  const PoseEstimate estimate = filter_.estimate();
  out.map_T_scan = estimate.map_T_scan * out.update_T_scan;
  out.map_T_odom = out.map_T_scan * motion.odom_T_current.inverse();
  const double agreement = estimate.agreement * since_update_.weight() * within_ok(since_update_);
  out.tracking = recovery_.state(agreement);
  out.probability = agreement * recovery_.probability();
  out.unconfirmed = recovery_.unconfirmed();
  if (out.unconfirmed > 0 && !is_in_graph_) {
    out.tracking = std::max(out.tracking, Tracking::kDoubtful);
    out.probability *= PoseEstimate::kUnconfirmed;
  }
  out.fit = recovery_.fit();
  return out;
}

void FilterStage::reset(const Pose2& map_T_scan) {
  begun_ = true;
  filter_.reset(map_T_scan);
  recovery_.reset();
  since_update_ = since_scan_ = Motion{};
  started_ = false;
}

void FilterStage::set_pose(const Pose2& map_T_scan) {
  begun_ = true;
  filter_.set_pose(map_T_scan);
  recovery_.trust();
  restart(since_update_.steps > 0 ? since_update_.to_stamp_ns : update_stamp_ns_);
}

}  // namespace odoless
