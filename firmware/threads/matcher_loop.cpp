#include "firmware/threads/matcher_loop.hpp"

#include "firmware/stages/stage_reports.hpp"

namespace odoless {
namespace {

/// Of the budget: when a search is told to end. What it ends with takes a quarter where the machine is quiet, and more
/// where its cores are shared.
constexpr double kDeadline = 0.6;

}  // namespace

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
  Motion motion;
  if (pipeline_.lossless) {
    motion = stage_.process(scan);
  } else {
    const CpuDeadline deadline(static_cast<std::int64_t>(kDeadline * static_cast<double>(budget_ns_)));
    motion = stage_.process(scan, deadline.view());
  }
  publish(motion);
  if (to_filter_) {
    hand_on({slot, motion, timer_.used_ns()});
  } else {
    give_back(slot);
  }
  timer_.end(report_.stage);
  report(motion);
  pipeline_.matcher.heartbeat.fetch_add(1, std::memory_order_relaxed);
}

void MatcherLoop::publish(const Motion& motion) {
  send(pipeline_, pipeline_.matcher.outbox, RecordType::kMotion, motion);
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
    message.motion = pending_.motion.then(message.motion);
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

void MatcherLoop::report(const Motion& motion) {
  enter(motion, report_);
  meter_.read(report_.stage);
  pipeline_.matcher.report.write(report_);
}

}  // namespace odoless
