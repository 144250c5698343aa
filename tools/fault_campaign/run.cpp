#include "tools/fault_campaign/run.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "firmware/health/health_text.hpp"
#include "rt/cpu_clock.hpp"
#include "tools/eval/report.hpp"
#include "tools/fault_campaign/confidence.hpp"

namespace odoless::campaign {
namespace {

/// The method as users have it; the frame is none that chance of the simulation draws from.
WatchedChain chain_of(const Scenario& scenario) {
  return {RobotParams{}, scenario.seed, spec_of(scenario.fault.kind).live};
}

const char* name_of(Tracking tracking) {
  return tracking == Tracking::kSure ? "sure" : tracking == Tracking::kDoubtful ? "doubtful" : "lost";
}

}  // namespace

Run::Run(const Scenario& scenario, const Drive& drive)
    : drive_(&drive), standstill_(standstill_of(scenario)), chain_(chain_of(scenario)), judge_(scenario.fault.end_s) {}

void Run::change(const Scenario& scenario) {
  standstill_ = standstill_of(scenario);
  judge_ = Judge(scenario.fault.end_s);
  const Pose2 map_T_scan = chain_.last().filter.map_T_scan;
  start_T_map_ = drive_->start_T_robot(last_true_s_) * map_T_scan.inverse();
}

void Run::advance(const ScanStream& stream, double until_s) {
  const std::int64_t taken_until_ns = host_ns(static_cast<double>(ticks_ - 1) * kTick_s);
  std::size_t next = static_cast<std::size_t>(
      std::ranges::count_if(stream.scans, [&](const SentScan& scan) { return scan.arrival_ns < taken_until_ns; }));
  for (double tick_s = static_cast<double>(ticks_) * kTick_s; tick_s < until_s;
       tick_s = static_cast<double>(++ticks_) * kTick_s) {
    for (; next < stream.scans.size() && stream.scans[next].arrival_ns < host_ns(tick_s); ++next) {
      take(stream, stream.scans[next]);
    }
    tick(tick_s);
  }
}

void Run::take(const ScanStream& stream, const SentScan& scan) {
  const double time_s = since_start_s(scan.arrival_ns);
  const bool accepted = chain_.process(stream.raw(scan), scan.arrival_ns) == ScanVerdict::kAccepted;
  if (accepted) {
    last_true_s_ = scan.true_s;
    if (!has_map_) {
      start_T_map_ = drive_->start_T_robot(scan.true_s);
      has_map_ = true;
    }
  }
  observe(time_s, accepted ? "scan" : "refused", accepted);
}

void Run::tick(double time_s) {
  const bool stands_still = time_s >= standstill_.from_s && time_s < standstill_.until_s;
  if (!stands_still) {
    observe(time_s, "tick", false);
  }
}

Pose2 Run::error(double time_s, bool is_scan) const {
  const double of_s = !is_scan && time_s - last_true_s_ > kOld_s ? time_s : last_true_s_;
  return true_map_T_scan(of_s).inverse() * chain_.last().filter.map_T_scan;
}

void Run::observe(double time_s, const char* event, bool is_scan) {
  const HealthReport& report = chain_.health(host_ns(time_s));
  Observation seen{.time_s = time_s, .state = report.state, .is_scan = is_scan};
  if (chain_.has_pose()) {
    const Pose2 off = error(time_s, is_scan);
    seen.error_m = off.distance_m({});
    seen.error_rad = off.yaw_rad;
    seen.confidence = said_probability(report.state, chain_.last().filter);
  }
  last_error_m_ = is_scan ? seen.error_m : last_error_m_;
  judge_.add(seen);
  if (trace_ != nullptr) {
    write_trace(seen, event, report);
  }
}

void Run::write_trace(const Observation& seen, const char* event, const HealthReport& report) {
  const FilterStep& step = chain_.last().filter;
  const Pose2 map_T_true = true_map_T_scan(seen.time_s);
  std::string reasons = reasons_text(report.reasons);
  std::ranges::replace(reasons, ',', ';');
  trace_->text += fmt::format("{:.3f},{},{},{},{:.3f},{:.3f},{:.2f},{:.3f},{},{},{},{:.3f},{:.3f},", seen.time_s, event,
                              odoless::name_of(seen.state), reasons, seen.confidence, seen.error_m,
                              to_deg(seen.error_rad), step.fit, name_of(step.tracking), step.updated ? 1 : 0,
                              step.found ? 1 : 0, seen.time_s - last_true_s_, since_start_s(chain_.last().stamp_ns));
  trace_->text +=
      fmt::format("{:.3f},{:.3f},{:.2f},{:.3f},{:.3f},{:.2f}\n", step.map_T_scan.x_m, step.map_T_scan.y_m,
                  to_deg(step.map_T_scan.yaw_rad), map_T_true.x_m, map_T_true.y_m, to_deg(map_T_true.yaw_rad));
}

RunResult play(const Scenario& scenario, Trace* trace) {
  const std::int64_t begin_ns = thread_cpu_ns();
  const Drive drive(scenario);
  ScanStream stream = clean_stream(scenario, drive);
  apply_fault(scenario, stream);
  Run run(scenario, drive);
  if (trace != nullptr) {
    trace->text = Trace::kHeader;
    run.trace_to(trace);
  }
  run.advance(stream, scenario.duration_s);
  return {scenario, run.verdict(), static_cast<double>(thread_cpu_ns() - begin_ns) * 1e-9};
}

}  // namespace odoless::campaign
