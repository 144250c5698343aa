#include "firmware/health/health_monitor.hpp"

#include <algorithm>
#include <array>

namespace odoless {
namespace {

StageHealth health_of(const StageReport& stage) {
  constexpr double kMsPerNs = 1e-6;
  return {.scans = stage.scans,
          .p50_ms = static_cast<double>(stage.cpu.percentile(50.0)) * kMsPerNs,
          .p99_ms = static_cast<double>(stage.cpu.percentile(99.0)) * kMsPerNs,
          .max_ms = static_cast<double>(stage.cpu.max()) * kMsPerNs,
          .longest = stage.longest,
          .budget_ms = static_cast<double>(stage.budget_ns) * kMsPerNs,
          .deadline_misses = stage.deadline_misses};
}

// Bad scans are a reason for no longer: after as many good ones, poses are as good as before. A process that was
// stopped for a moment has some, cut short or late, and must be OK within a second.
constexpr std::int64_t kBadScanMemory_ns = 500'000'000;

// A laser that sweeps as it was told passes the level again and again. Without a level scan for longer, poses are old.
constexpr std::int64_t kSweepMemory_ns = 2'000'000'000;

// The probability that the place in a continued world is right. A guess is rarely wrong in the building that it is of,
// but often in another one with like corridors: it must not be OK.
constexpr std::array<double, 3> kPlaceRight{0.0, 0.7, 1.0};

WorldPlaceKnown place_of(const Surroundings& surroundings) {
  return surroundings.graph ? surroundings.graph->place : WorldPlaceKnown::kSure;
}

std::uint32_t when(bool holds, HealthReason reason) { return holds ? reason : 0U; }

}  // namespace

bool HealthMonitor::Growth::update(std::int64_t count, std::int64_t now_ns, std::int64_t memory_ns) {
  if (count > count_) {
    grew_at_ns_ = now_ns;
  }
  count_ = count;
  return grew_at_ns_ != INT64_MIN && now_ns - grew_at_ns_ < memory_ns;
}

const HealthReport& HealthMonitor::update(const SensorReport& sensor, const MatcherReport& matcher,
                                          const FilterReport& filter, const Surroundings& surroundings,
                                          std::int64_t now_ns) {
  began_ns_ = began_ns_ == 0 ? now_ns : began_ns_;
  copy_figures(sensor, matcher, filter, surroundings, now_ns);
  report_.reasons = surroundings.standing_reasons | sensor_reasons(sensor, surroundings, now_ns) |
                    estimate_reasons(matcher, filter, now_ns) | load_reasons(report_, now_ns) |
                    when(surroundings.stage_silent, kReasonStageSilent) | when(surroundings.stopped, kReasonStopped) |
                    when(surroundings.gpio_lost, kReasonGpio) | when(surroundings.storage_error != 0, kReasonStorage) |
                    when(cloud_refused_.update(surroundings.cloud ? surroundings.cloud->refused : 0, now_ns,
                                               params_.deadline_memory_ns),
                         kReasonCloudFull) |
                    when(surroundings.graph && surroundings.graph->used >= 1.0, kReasonMapFull) |
                    when(place_of(surroundings) != WorldPlaceKnown::kSure, kReasonNotInWorld) |
                    when(surroundings.graph && surroundings.graph->has_drifted, kReasonDrift);
  report_.latched_reasons |= report_.reasons;
  report_.state = state_of(sensor, filter, place_of(surroundings));
  return report_;
}

std::uint32_t HealthMonitor::sensor_reasons(const SensorReport& sensor, const Surroundings& surroundings,
                                            std::int64_t now_ns) {
  const std::int64_t age_ns = now_ns - sensor.last_scan_ns;
  const auto silent_ns = static_cast<std::int64_t>(params_.silent_periods * static_cast<double>(sensor.period_ns));
  const bool silent = sensor.last_scan_ns == 0 || age_ns > std::max(silent_ns, std::int64_t{1});
  const bool has_level_scans =
      level_scans_.update(sensor.source.accepted - sensor.tilt.held_back, now_ns, kSweepMemory_ns);
  const bool is_tilted = sensor.tilt.used && !sensor.tilt.level;
  const bool sweeps = is_tilted && sensor.tilt.sweeps && has_level_scans;
  const bool was_expected = sensor.period_ns > 0 || now_ns - began_ns_ > params_.fault_after_ns;
  return when(silent && was_expected, kReasonNoScans) |
         when(!sensor.open && (surroundings.device_tried || sensor.last_scan_ns != 0), kReasonDeviceClosed) |
         when(rejected_.update(sensor.source.rejected + sensor.source.late, now_ns,
                               std::min(kBadScanMemory_ns, params_.deadline_memory_ns)),
              kReasonBadScans) |
         when(motions_refused_.update(sensor.source.motions_refused, now_ns, params_.deadline_memory_ns),
              kReasonBadMotions) |
         when(not_authentic_.update(sensor.source.forged + sensor.source.replayed, now_ns, params_.deadline_memory_ns),
              kReasonNotAuthentic) |
         when(sensor.tilt.used && !sensor.tilt.obeys, kReasonTilt) |
         when(tilt_refused_.update(sensor.tilt.refused, now_ns, params_.deadline_memory_ns), kReasonBadTilt) |
         when(is_tilted && !sweeps, kReasonNotLevel) | when(sweeps, kReasonSweep) | when(sensor.blind, kReasonBlind) |
         when(sensor.stuck, kReasonStuck) |
         when(lost_datagrams_.update(sensor.source.datagrams_lost, now_ns, params_.deadline_memory_ns),
              kReasonDatagramsLost);
}

std::uint32_t HealthMonitor::estimate_reasons(const MatcherReport& matcher, const FilterReport& filter,
                                              std::int64_t now_ns) {
  return when(matcher.poor_in_a_row >= params_.poor_matches, kReasonPoorMatch) |
         when(matcher.stage.scans > 1 && matcher.weak_information_1_m2 < params_.weak_information_1_m2,
              kReasonWeakDirection) |
         when(filter.lost || filter.doubtful, kReasonDiverged) | when(filter.paused, kReasonPaused) |
         when(map_refused_.update(filter.refused_tiles, now_ns, params_.deadline_memory_ns), kReasonMapFull);
}

std::uint32_t HealthMonitor::load_reasons(const HealthReport& report, std::int64_t now_ns) {
  std::int64_t misses = 0;
  for (const StageHealth& stage : report.stages) {
    misses += stage.deadline_misses;
  }
  const std::int64_t dropped = report.lrf.dropped + report.records_dropped + report.updates_cut;
  return when(missed_.update(misses, now_ns, params_.deadline_memory_ns), kReasonDeadlineMissed) |
         when(dropped_.update(dropped, now_ns, params_.deadline_memory_ns), kReasonOverload) |
         when(unpublished_.update(report.publish_errors, now_ns, params_.deadline_memory_ns), kReasonPublishing);
}

HealthState HealthMonitor::state_of(const SensorReport& sensor, const FilterReport& filter,
                                    WorldPlaceKnown place) const {
  if ((report_.reasons & (kReasonStageSilent)) != 0) {
    return HealthState::kFault;
  }
  const bool no_scans = (report_.reasons & (kReasonNoScans | kReasonDeviceClosed)) != 0;
  if (no_scans && (sensor.last_scan_ns == 0 ? (report_.reasons & kReasonDeviceClosed) != 0
                                            : report_.lrf.age_s * 1e9 > static_cast<double>(params_.fault_after_ns))) {
    return HealthState::kFault;
  }
  if (filter.stage.scans == 0) {
    return HealthState::kInit;
  }
  if (filter.lost || place == WorldPlaceKnown::kNo) {
    return HealthState::kLost;
  }
  constexpr std::uint32_t kHarmless =
      kReasonPaused | kReasonPublishing | kReasonStorage | kReasonStopped | kReasonCloudFull | kReasonSweep;
  return (report_.reasons & ~kHarmless) != 0 ? HealthState::kDegraded : HealthState::kOk;
}

void HealthMonitor::copy_figures(const SensorReport& sensor, const MatcherReport& matcher, const FilterReport& filter,
                                 const Surroundings& surroundings, std::int64_t now_ns) {
  report_.stamp_ns = now_ns;
  report_.lrf = sensor.source;
  report_.scans_not_level = sensor.tilt.held_back;
  report_.lrf.age_s = sensor.last_scan_ns == 0 ? -1.0 : static_cast<double>(now_ns - sensor.last_scan_ns) * 1e-9;
  report_.lrf.rate_hz = sensor.period_ns <= 0 ? 0.0 : 1e9 / static_cast<double>(sensor.period_ns);
  report_.fitness = matcher.fitness;
  report_.second_peak_ratio = matcher.second_peak_ratio;
  report_.information_1_m2 = {matcher.strong_information_1_m2, matcher.weak_information_1_m2};
  report_.evaluations = matcher.evaluations;
  report_.deadline_hit = matcher.deadline_hit;
  report_.effective_particles = filter.effective_particles;
  report_.particles = filter.particles;
  report_.position_sd_m = filter.position_sd_m;
  report_.yaw_sd_rad = filter.yaw_sd_rad;
  report_.pose_probability = filter.pose_probability *
                             kPlaceRight.at(static_cast<std::size_t>(place_of(surroundings))) *
                             (surroundings.graph ? surroundings.graph->undrifted : 1.0);
  report_.stages = {health_of(sensor.stage), health_of(matcher.stage), health_of(filter.stage)};
  report_.page_faults = sensor.stage.page_faults + matcher.stage.page_faults + filter.stage.page_faults;
  report_.allocations = std::min({sensor.stage.allocations, matcher.stage.allocations, filter.stage.allocations}) < 0
                            ? -1
                            : sensor.stage.allocations + matcher.stage.allocations + filter.stage.allocations;
  report_.scan_queue_high_water = surroundings.scan_queue_high_water;
  report_.motion_queue_high_water = surroundings.motion_queue_high_water;
  report_.updates_cut = filter.updates_cut;
  report_.map_pool_used = filter.pool_used;
  report_.records_dropped = surroundings.records_dropped;
  report_.publish_errors = surroundings.publish_errors;
  report_.storage_error = surroundings.storage_error;
  report_.checkpoint_age_s = surroundings.checkpoint_age_s;
  report_.cloud = surroundings.cloud;
  report_.graph = surroundings.graph;
  report_.world = surroundings.world;
}

}  // namespace odoless
