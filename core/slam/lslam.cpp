#include "core/slam/lslam.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "core/base/check.hpp"
#include "core/slam/particle_weights.hpp"

namespace odoless {
namespace {

bool is_finite(const Pose2& pose) {
  return std::isfinite(pose.x_m) && std::isfinite(pose.y_m) && std::isfinite(pose.yaw_rad);
}

int index_of_highest(std::span<const double> weights) {
  return static_cast<int>(std::distance(weights.begin(), std::max_element(weights.begin(), weights.end())));
}

}  // namespace

Lslam::Lslam(const LslamParams& params, std::uint64_t seed)
    : params_(params),
      motion_(params.motion),
      model_(params.beam, params.grid.resolution_m),
      grid_(params.grid, params.particles),
      paths_(std::max(params.path_records_max, 16 * params.particles), params.particles),
      rng_(seed),
      wanted_particles_(params.particles) {
  ODOLESS_CHECK(parameters_in_range(params));
  const auto particles = static_cast<std::size_t>(params.particles);
  poses_.resize(particles);
  old_poses_.resize(particles);
  log_weights_.resize(particles);
  weights_.resize(particles);
  scores_.resize(particles);
  copies_.resize(particles);
  scratch_.resize(particles);
  beams_.reserve(static_cast<std::size_t>(params.beams_used));
  reset({});
}

void Lslam::reset(const Pose2& map_T_scan) {
  ODOLESS_CHECK(is_finite(map_T_scan));
  grid_.reset();
  paths_.reset();
  speed_.reset();
  poses_[0] = map_T_scan;
  log_weights_[0] = 0.0;
  weights_[0] = 1.0;
  best_ = 0;
  started_ = pool_was_full_ = false;
}

void Lslam::set_particles(int wanted) {
  ODOLESS_CHECK(wanted >= 1 && wanted <= params_.particles);
  wanted_particles_ = wanted;
}

void Lslam::set_pose(const Pose2& map_T_scan) {
  ODOLESS_CHECK(is_finite(map_T_scan));
  std::fill(poses_.begin(), poses_.end(), map_T_scan);
}

UpdateReport Lslam::update(const MotionIncrement& increment, const ScanFrame& scan) {
  UpdateReport report;
  const AncestryGrid::Counters before = grid_.counters();
  const std::int64_t thinned_before = paths_.thinned();
  if (started_) {
    move(increment, report);
    weigh(scan, report);
    report.resampled = select_survivors(report);
  } else {
    copies_[0] = wanted_particles_;
    report.effective_particles = 1.0;
    report.resampled = started_ = true;
  }
  paths_.next_update();
  if (report.resampled) {
    grid_.retain(living(copies_));
    paths_.retain(living(copies_));
  }
  map_scan(scan, report.resampled);
  if (report.resampled) {
    multiply();
  }
  count(before, thinned_before, report);
  return report;
}

double Lslam::effective_particles() const {
  return odoless::effective_particles(std::span(weights_).first(static_cast<std::size_t>(particles())));
}

std::size_t Lslam::memory_bytes() const {
  return sizeof(*this) + grid_.memory_bytes() + paths_.memory_bytes() +
         (poses_.capacity() + old_poses_.capacity()) * sizeof(Pose2) +
         (log_weights_.capacity() + weights_.capacity() + scores_.capacity()) * sizeof(double) +
         (copies_.capacity() + scratch_.capacity()) * sizeof(int) + beams_.capacity() * sizeof(Beam);
}

void Lslam::move(const MotionIncrement& increment, UpdateReport& report) {
  ODOLESS_CHECK(is_finite(increment.previous_T_current));
  const AxisDeviations match{increment.sd_x_m, increment.sd_y_m, increment.sd_yaw_rad};
  report.lambda_m = speed_.lambda_m(increment);
  for (Pose2& pose : living(poses_)) {
    pose = motion_.sample(pose, increment.previous_T_current, report.lambda_m, match, rng_);
  }
  speed_.add(increment);
}

void Lslam::weigh(const ScanFrame& scan, UpdateReport& report) {
  select_beams(scan, params_.beams_used, params_.weigh_no_return, beams_);
  report.beams_weighed = static_cast<int>(beams_.size());
  if (!beams_.empty()) {
    for (int particle = 0; particle < particles(); ++particle) {
      const auto i = static_cast<std::size_t>(particle);
      const ScoredPose found = refined(particle, beams_);
      poses_[i] = found.pose;
      scores_[i] = found.score;
      log_weights_[i] += params_.tempering * found.score;
    }
  }
  normalise_weights(living(log_weights_), living(weights_));
  best_ = index_of_highest(living(weights_));
  report.effective_particles = effective_particles();
  report.log_likelihood_per_beam =
      beams_.empty() ? 0.0 : scores_[static_cast<std::size_t>(best_)] / static_cast<double>(beams_.size());
}

ScoredPose Lslam::refined(int particle, std::span<const Beam> beams) {
  AncestryGrid::View view = grid_.view(particle);
  const double cells_per_m = 1.0 / params_.grid.resolution_m;
  const auto score = [&](const Pose2& map_T_scan) {
    return log_likelihood(model_, BeamCaster(grid_.geometry(), map_T_scan), view, beams, cells_per_m);
  };
  return climb(pose(particle), params_.refine_step_m, params_.refine_step_rad, params_.refine_steps, score);
}

/// Decides about a resampling; fills copies_ if there is one.
bool Lslam::select_survivors(UpdateReport& report) {
  if (pool_was_full_) {
    drop_weakest_half(living(weights_), living(scratch_));
  } else if (report.effective_particles >= params_.resample_below * particles() && wanted_particles_ >= particles()) {
    return false;
  }
  systematic_copies(living(weights_), wanted_particles_, rng_.uniform(), living(copies_));
  return true;
}

void Lslam::map_scan(const ScanFrame& scan, bool only_survivors) {
  for (int particle = 0; particle < particles(); ++particle) {
    if (only_survivors && copies_[static_cast<std::size_t>(particle)] == 0) {
      continue;
    }
    AncestryGrid::Writer writer = grid_.writer(particle);
    const BeamCaster caster(grid_.geometry(), pose(particle));
    integrate_scan(model_, caster, writer, scan, params_.free_no_return_m);
    paths_.append(particle, {.stamp_ns = scan.stamp_ns(), .map_T_scan = pose(particle)});
  }
}

/// Replaces every survivor by its copies, all of the same weight.
void Lslam::multiply() {
  const std::span<const int> copies = living(copies_);
  const int old_best = best_;
  old_poses_.swap(poses_);
  std::size_t next = 0;
  best_ = 0;
  for (std::size_t i = 0; i < copies.size(); ++i) {
    best_ = static_cast<int>(i) == old_best ? static_cast<int>(next) : best_;
    std::fill_n(poses_.begin() + static_cast<std::ptrdiff_t>(next), copies[i], old_poses_[i]);
    next += static_cast<std::size_t>(copies[i]);
  }
  best_ = std::min(best_, wanted_particles_ - 1);
  grid_.branch(copies);
  paths_.branch(copies);
  std::fill(log_weights_.begin(), log_weights_.end(), 0.0);
  std::fill(weights_.begin(), weights_.end(), 1.0 / particles());
}

void Lslam::count(const AncestryGrid::Counters& before, std::int64_t thinned_before, UpdateReport& report) {
  report.refused_tiles = grid_.counters().refused_tiles - before.refused_tiles;
  report.outside_tiles = grid_.counters().outside_tiles - before.outside_tiles;
  report.thinned_poses = paths_.thinned() - thinned_before;
  pool_was_full_ = report.refused_tiles > 0;
}

}  // namespace odoless
