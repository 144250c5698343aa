#include "firmware/threads/filter_loop.hpp"

#include <algorithm>

#include "firmware/stages/stage_reports.hpp"

namespace odoless {
namespace {

constexpr double kScanDeadline = 0.9;  // of the budget of both

}  // namespace

FilterLoop::FilterLoop(Pipeline& pipeline, FilterStage& stage, const PipelineParams& params, double map_refresh_s)
    : pipeline_(pipeline),
      stage_(stage),
      params_(params),
      particles_min_(std::min(params.particles_min, stage.filter().params().low.particles)),
      particles_(stage.filter().params().low.particles),
      tiles_(stage, map_refresh_s),
      timer_(params.filter_budget_ns) {
  if (!pipeline.lossless) {
    particles_ = particles_min_;  // what an update costs here is not known yet
    stage_.set_particles(particles_min_);
  }
}

void FilterLoop::run(const std::atomic<bool>& before) {
  for (bool last_round = false; !last_round;) {
    last_round = before.load(std::memory_order_acquire);
    for (FilterCommand command; pipeline_.commands.try_pop(command);) {
      obey(command);
    }
    for (MotionMessage message; !pipeline_.abandoning && pipeline_.motions.try_pop(message);) {
      process(message);
    }
    pipeline_.filter.heartbeat.fetch_add(1, std::memory_order_relaxed);
    if (!last_round) {
      pipeline_.filter.wake.wait(kIdle_ns);
    }
  }
  pipeline_.filter.done.store(true, std::memory_order_release);
}

void FilterLoop::process(const MotionMessage& message) {
  timer_.begin();
  const std::int64_t time_ns = update_time_ns(message);
  const CpuDeadline deadline(time_ns);
  const int particles = stage_.filter().particles();
  const FilterStep step = message.slot == kNoSlot ? stage_.process(message.motion)
                                                  : stage_.process(pipeline_.pool.at(message.slot), message.motion,
                                                                   pipeline_.lossless ? Deadline{} : deadline.view());
  tell_keyframe(message, step);
  if (message.slot != kNoSlot) {
    const bool pushed = pipeline_.slots_from_filter.try_push(message.slot);
    ODOLESS_CHECK(pushed);  // there is room for every slot
  }
  publish(step, message.motion);
  const std::int64_t used_ns = timer_.end(report_.stage);
  report_.with_matcher.record(used_ns + message.matcher_cpu_ns);
  if (step.updated && !pipeline_.lossless) {
    adapt(particles, used_ns, time_ns);
  }
  report();
  pipeline_.filter.heartbeat.fetch_add(1, std::memory_order_relaxed);
}

void FilterLoop::tell_keyframe(const MotionMessage& message, const FilterStep& step) {
  if (keyframes_ && keyframes_->add(message.motion, step.unknown_s) && message.slot != kNoSlot && !stage_.paused()) {
    keyframes_->send(pipeline_, pipeline_.pool.at(message.slot), step.map_T_odom, map_number_);
  }
}

void FilterLoop::obey(const FilterCommand& command) {
  switch (command.kind) {
    case FilterCommand::Kind::kReset:
      ++map_number_;
      return stage_.reset(command.map_T_scan);
    case FilterCommand::Kind::kSetPose:
      return stage_.set_pose(command.map_T_scan);
    case FilterCommand::Kind::kPause:
    case FilterCommand::Kind::kResume:
      return stage_.pause(command.kind == FilterCommand::Kind::kPause);
  }
}

std::int64_t FilterLoop::update_time_ns(const MotionMessage& message) const {
  constexpr double kDeadline = 0.75;  // of the budget; the rest is for what an update ends with
  const double own_ns = kDeadline * static_cast<double>(params_.filter_budget_ns);
  const double left_ns =
      kScanDeadline * static_cast<double>(params_.scan_budget_ns) - static_cast<double>(message.matcher_cpu_ns);
  return static_cast<std::int64_t>(std::clamp(left_ns, 0.0, own_ns));
}

// An update's time is nearly all the particles'. Slowly up, at once down.
void FilterLoop::adapt(int particles, std::int64_t used_ns, std::int64_t time_ns) {
  constexpr double kAim = 0.4;          // of the budget: one update may take much longer than the one before
  constexpr double kAimWithLess = 0.8;  // where matches leave less
  constexpr double kGrowth = 1.05;      // at most, from one update to the next
  const double aim_ns =
      std::min(kAim * static_cast<double>(params_.filter_budget_ns), kAimWithLess * static_cast<double>(time_ns));
  const double wanted = std::min(kGrowth * particles_, particles * aim_ns / static_cast<double>(used_ns));
  particles_ = std::clamp<double>(wanted, particles_min_, stage_.filter().params().low.particles);
  stage_.set_particles(static_cast<int>(particles_));
}

void FilterLoop::publish(const FilterStep& step, const Motion& motion) {
  const PoseEstimate estimate = stage_.filter().estimate();
  PoseRecord record = pose_record_of(step, estimate, stage_, motion.to_stamp_ns);
  record.odom_T_scan = motion.odom_T_current;
  record.map_number = map_number_;
  send(pipeline_, pipeline_.filter.outbox, RecordType::kPose, record);
  if (!keyframes_) {  // else the map is made of those
    tiles_.send(pipeline_.filter.outbox, step, record.stamp_ns, motion.to_stamp_ns - motion.from_stamp_ns);
  }
  if (tells_path_ && step.updated) {
    path_.send(pipeline_.filter.outbox, stage_.filter(), record.stamp_ns);
  }
  enter(step, estimate, stage_, report_);
}

void FilterLoop::report() {
  meter_.read(report_.stage);
  pipeline_.filter.report.write(report_);
}

}  // namespace odoless
