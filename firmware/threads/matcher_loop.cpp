#include "firmware/threads/matcher_loop.hpp"

#include <algorithm>
#include <cmath>

#include "firmware/records/convert.hpp"

namespace odoless {

OdometryStep compose(const OdometryStep& first, const OdometryStep& second) {
  OdometryStep sum = second;
  sum.from_stamp_ns = first.from_stamp_ns;
  const double c = std::cos(first.previous_T_current.yaw_rad);
  const double s = std::sin(first.previous_T_current.yaw_rad);
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  turn.topLeftCorner<2, 2>() << c, -s, s, c;
  sum.previous_T_current = first.previous_T_current * second.previous_T_current;
  sum.covariance = first.covariance + turn * second.covariance * turn.transpose();
  sum.error = first.error.then(second.error);
  return sum;
}

MatcherLoop::MatcherLoop(Pipeline& pipeline, MatcherStage& stage, std::int64_t budget_ns, bool to_filter)
    : pipeline_(pipeline), stage_(stage), budget_ns_(budget_ns), to_filter_(to_filter), timer_(budget_ns) {}

void MatcherLoop::run() {
  for (bool last_round = false; !last_round;) {
    last_round = pipeline_.sensor.done.load(std::memory_order_acquire);
    while (const std::optional<ScanSlot> slot = pipeline_.abandoning ? std::nullopt : pipeline_.scans.try_pop()) {
      process(*slot);
    }
    flush();
    pipeline_.matcher.heartbeat.fetch_add(1, std::memory_order_relaxed);
    if (!last_round) {
      pipeline_.matcher.wake.wait(kIdle_ns);
    }
  }
  while (pending_.slot != kNoSlot && !pipeline_.abandoning) {
    flush();
    sleep_ns(kRoomWait_ns);
  }
  pipeline_.matcher.done.store(true, std::memory_order_release);
  pipeline_.filter.wake.notify();
}

void MatcherLoop::process(ScanSlot slot) {
  timer_.begin();
  ScanFrame& scan = pipeline_.pool.at(slot);
  OdometryStep step;
  if (pipeline_.lossless) {
    step = stage_.process(scan);
  } else {
    const CpuDeadline deadline(static_cast<std::int64_t>(kDeadline * static_cast<double>(budget_ns_)));
    step = stage_.process(scan, deadline.view());
  }
  publish(step);
  if (to_filter_) {
    hand_on({slot, step, timer_.used_ns()});
  } else {
    give_back(slot);
  }
  timer_.end(report_.stage);
  report(step);
  pipeline_.matcher.heartbeat.fetch_add(1, std::memory_order_relaxed);
}

void MatcherLoop::publish(const OdometryStep& step) {
  send(pipeline_, pipeline_.matcher.outbox, RecordType::kMotion, to_record(step));
}

void MatcherLoop::give_back(ScanSlot slot) {
  const bool pushed = pipeline_.slots_from_matcher.try_push(slot);
  ODOLESS_CHECK(pushed);  // there is room for every slot
}

bool MatcherLoop::push(const MotionMessage& message) {
  if (pipeline_.motions.size() == pipeline_.motions.capacity() || !pipeline_.motions.try_push(message)) {
    return false;
  }
  pipeline_.filter.wake.notify();
  return true;
}

void MatcherLoop::hand_on(MotionMessage message) {
  while (pipeline_.lossless && !push(message) && !pipeline_.abandoning) {
    sleep_ns(kRoomWait_ns);
  }
  if (pipeline_.lossless) {
    return;
  }
  if (pending_.slot != kNoSlot) {
    give_back(pending_.slot);
    message.step = compose(pending_.step, message.step);
    pending_.slot = kNoSlot;
  }
  if (!push(message)) {
    pending_ = message;
  }
}

void MatcherLoop::flush() {
  if (pending_.slot != kNoSlot && push(pending_)) {
    pending_.slot = kNoSlot;
  }
}

void MatcherLoop::report(const OdometryStep& step) {
  report_.fitness = step.match.fitness;
  report_.second_peak_ratio = second_peak_ratio(step.match);
  report_.strong_information_1_m2 = step.match.strong_information_1_m2;
  report_.weak_information_1_m2 = step.match.weak_information_1_m2;
  report_.evaluations = step.match.evaluations;
  report_.poor_in_a_row = step.match.converged || report_.stage.scans <= 1 ? 0 : report_.poor_in_a_row + 1;
  report_.deadline_hit = step.match.stop == StopReason::kDeadline;
  meter_.read(report_.stage);
  pipeline_.matcher.report.write(report_);
}

}  // namespace odoless
