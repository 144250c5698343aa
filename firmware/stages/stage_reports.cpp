#include "firmware/stages/stage_reports.hpp"

#include <cmath>

namespace odoless {

void enter(const SensorStage& stage, SensorReport& report) {
  report.source = stage.counts();
  report.last_scan_ns = stage.last_scan_ns();
  report.period_ns = stage.period_ns();
  report.blind = stage.is_blind();
  report.stuck = stage.is_stuck();
}

void enter(const Motion& motion, MatcherReport& report) {
  report.fitness = motion.fitness;
  report.second_peak_ratio = motion.second_peak_ratio;
  report.strong_information_1_m2 = motion.strong_information_1_m2;
  report.weak_information_1_m2 = motion.weak_information_1_m2;
  report.evaluations = motion.evaluations;
  report.poor_in_a_row = motion.has(kConverged) || report.stage.scans <= 1 ? 0 : report.poor_in_a_row + 1;
  report.deadline_hit = motion.has(kDeadlineHit);
}

PoseRecord pose_record_of(const FilterStep& step, const PoseEstimate& estimate, FilterStage& stage,
                          std::int64_t stamp_ns) {
  PoseRecord record;
  record.stamp_ns = stamp_ns;
  record.laser = stage.laser();
  record.map_T_scan = step.map_T_scan;
  record.map_T_odom = step.map_T_odom;
  Eigen::Map<Eigen::Matrix3d>(record.covariance.data()) = estimate.covariance + step.drift;  // symmetric
  record.update_stamp_ns = step.update_stamp_ns;
  record.update_T_scan = step.update_T_scan;
  record.effective_particles = stage.filter().effective_particles();
  record.log_likelihood_per_beam = step.report.log_likelihood_per_beam;
  record.particles = stage.filter().particles();
  record.updated = step.updated ? 1 : 0;
  record.placements = step.placements;
  record.unconfirmed = step.unconfirmed;
  return record;
}

void enter(const FilterStep& step, const PoseEstimate& estimate, FilterStage& stage, FilterReport& report) {
  report.position_sd_m = std::sqrt(estimate.covariance(0, 0) + estimate.covariance(1, 1));
  report.yaw_sd_rad = std::sqrt(estimate.covariance(2, 2));
  report.pose_probability = step.probability;
  report.effective_particles = stage.filter().effective_particles();
  report.particles = stage.filter().particles();
  if (step.updated) {
    report.log_likelihood_per_beam = step.report.log_likelihood_per_beam;
    report.refused_tiles += step.report.refused_tiles;
    report.updates_cut += step.report.unweighed_particles + step.report.thinly_mapped_particles > 0 ? 1 : 0;
  }
  report.pool_used = stage.filter().pool_used();
  report.paused = stage.paused();
  report.doubtful = step.tracking == Tracking::kDoubtful;
  report.lost = step.tracking == Tracking::kLost;
}

}  // namespace odoless
