#include "core/slam/lslam.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/check.hpp"

namespace odoless {
namespace {

bool is_finite(const Pose2& pose) {
  return std::isfinite(pose.x_m) && std::isfinite(pose.y_m) && std::isfinite(pose.yaw_rad);
}

}  // namespace

Lslam::Lslam(const LslamParams& params, std::uint64_t seed)
    : params_(params),
      motion_(params.motion),
      model_(params.beam, params.grid.resolution_m),
      particles_(params.grid, params.particles, params.path_records_max),
      kld_(params.particles),
      rng_(seed),
      wanted_particles_(params.particles) {
  ODOLESS_CHECK(parameters_in_range(params));
  scores_.resize(static_cast<std::size_t>(params.particles));
  errors_.resize(scores_.size());
  old_errors_.resize(scores_.size());
  beams_.reserve(static_cast<std::size_t>(params.beams_used));
  reset({});
}

void Lslam::reset(const Pose2& map_T_scan) {
  ODOLESS_CHECK(is_finite(map_T_scan));
  particles_.reset(map_T_scan);
  particles_.grid().centre_on(cell_of(map_T_scan));
  travel_m_ = 0.0;
  turn_ = 0;
  speed_.reset();
  errors_[0] = DrawnError{};
  started_ = pool_was_full_ = false;
}

void Lslam::set_particles(int wanted) {
  ODOLESS_CHECK(wanted >= 1 && wanted <= params_.particles);
  wanted_particles_ = wanted;
}

void Lslam::set_pose(const Pose2& map_T_scan, const PoseSpread& spread) {
  ODOLESS_CHECK(is_finite(map_T_scan));
  particles_.set_pose(map_T_scan, spread, rng_);
  std::fill(errors_.begin(), errors_.end(), DrawnError{});
  speed_.reset();  // of the motion before: it promises nothing for the time in between
}

UpdateReport Lslam::update(const Motion& motion, const ScanFrame& scan, const Deadline& deadline) {
  UpdateReport report;
  const AncestryGrid::Counters before = particles_.grid().counters();
  const std::int64_t thinned_before = particles_.paths().thinned();
  if (started_) {
    move(motion, report);
    weigh(scan, deadline, report);
    report.resampled = select_survivors(report);
    move_window(motion);
  } else {
    particles_.spread_the_first(wanted_particles_);
    report.effective_particles = 1.0;
    report.resampled = started_ = true;
  }
  particles_.next_step();
  if (report.resampled) {
    particles_.retain();
  }
  map_scan(scan, deadline, report);
  if (report.resampled) {
    errors_.swap(old_errors_);
    particles_.multiply_alike(old_errors_, errors_);
    particles_.multiply();
  }
  count(before, thinned_before, report);
  return report;
}

void Lslam::move_window(const Motion& motion) {
  constexpr int kTiles = 256;  // of a window of 100 m all are looked at every 61 updates
  AncestryGrid& grid = particles_.grid();
  grid.follow(cell_of(pose(best())));
  travel_m_ += motion.previous_T_current.distance_m({});
  grid.set_travel(travel_m_);
  if (params_.forget_after_m > 0.0) {
    grid.forget_before(travel_m_ - params_.forget_after_m, kTiles);
  }
}

GridCell Lslam::cell_of(const Pose2& map_T_scan) const {
  constexpr double kFar_cells = 1e9;  // as far as cells are counted
  const Point2 cells = geometry().cells(map_T_scan.x_m, map_T_scan.y_m);
  const auto at = [=](double x) { return static_cast<int>(std::floor(std::clamp(x, -kFar_cells, kFar_cells))); };
  return {at(cells.x_m), at(cells.y_m)};
}

void Lslam::move(const Motion& motion, UpdateReport& report) {
  ODOLESS_CHECK(is_finite(motion.previous_T_current));
  const ErrorProcess process = motion.error();
  const ErrorProcess::Matrix root = root_of(process.noise);
  report.lambda_m = speed_.lambda_m(motion);
  for (int particle = 0; particle < particles(); ++particle) {
    Pose2& pose = particles_.pose(particle);
    DrawnError& error = errors_[static_cast<std::size_t>(particle)];
    const Pose2 map_T_tracked = pose * error.pose().inverse();
    error.advance(process, root, rng_);
    const Pose2& step = motion.alternative_count > 0 ? motion.at_share(rng_.uniform()) : motion.previous_T_current;
    pose = motion_.sample(map_T_tracked, step, report.lambda_m, rng_) * error.pose();
  }
  speed_.add(motion);
}

void Lslam::weigh(const ScanFrame& scan, const Deadline& deadline, UpdateReport& report) {
  select_beams(scan, params_.beams_used, params_.weigh_no_return, beams_);
  report.beams_weighed = static_cast<int>(beams_.size());
  if (!beams_.empty()) {
    weigh_until(deadline, report);
  }
  particles_.normalise();
  report.effective_particles = effective_particles();
  report.log_likelihood_per_beam =
      beams_.empty() ? 0.0 : scores_[static_cast<std::size_t>(best())] / static_cast<double>(beams_.size());
}

void Lslam::weigh_until(const Deadline& deadline, UpdateReport& report) {
  for (int particle = 0; particle < particles(); ++particle) {
    if (particle > 0 && deadline.expired()) {
      report.unweighed_particles = particles() - particle;
      return particles_.give_up_from(particle);
    }
    const ScoredPose found = refined(particle, beams_);
    particles_.pose(particle) = found.pose;
    scores_[static_cast<std::size_t>(particle)] = found.score;
    particles_.add_log_weight(particle, params_.tempering * found.score);
  }
}

ScoredPose Lslam::refined(int particle, std::span<const Beam> beams) {
  AncestryGrid::View view = map(particle);
  const double cells_per_m = 1.0 / params_.grid.resolution_m;
  const auto score = [&](const Pose2& map_T_scan) {
    return log_likelihood(model_, BeamCaster(geometry(), map_T_scan), view, beams, cells_per_m);
  };
  return climb(pose(particle), params_.refine_step_m, params_.refine_step_rad, params_.refine_steps, score);
}

/// Decides about a resampling, and what it keeps.
bool Lslam::select_survivors(UpdateReport& report) {
  const bool depleted = report.effective_particles < params_.resample_below * particles();
  const bool cut = report.unweighed_particles > 0;
  if (!pool_was_full_ && !depleted && !cut && wanted_particles_ >= particles()) {
    return false;
  }
  particles_.choose_survivors(particles_needed(), pool_was_full_, rng_);
  return true;
}

int Lslam::particles_needed() {
  if (params_.spread_error == 0.0) {
    return wanted_particles_;
  }
  const int needed = KldSampling::particles_for(particles_.bins(kld_), params_.spread_error);
  return std::min(std::max(needed, params_.particles_min), wanted_particles_);
}

void Lslam::map_scan(const ScanFrame& scan, const Deadline& deadline, UpdateReport& report) {
  const int step = std::max(1, (scan.size() + params_.beams_mapped - 1) / params_.beams_mapped);
  turn_ = (turn_ + 1) % step;
  const ScanPart beams(scan, turn_, scan.size(), step);
  for (int particle = 0; particle < particles(); ++particle) {
    if (report.resampled && !particles_.survives(particle)) {
      continue;
    }
    if (report.thinly_mapped_particles > 0) {
      ++report.unmapped_particles;
    } else if (!map_until(deadline, particle, beams)) {
      ++report.thinly_mapped_particles;
    }
    particles_.paths().append(particle, {.stamp_ns = scan.stamp_ns(), .map_T_scan = pose(particle)});
  }
}

/// False if the time was over: of the beams left then an even choice was taken, lest the map know one side alone.
bool Lslam::map_until(const Deadline& deadline, int particle, const ScanPart& part) {
  constexpr int kBeams = 64;  // from one question to the next, and after the last
  AncestryGrid::Writer writer = particles_.grid().writer(particle);
  const BeamCaster caster(geometry(), pose(particle));
  bool over = false;
  for (int first = part.first; first < part.end && !over; first += kBeams * part.step) {
    over = deadline.expired();
    const int beams = (part.end - first + part.step - 1) / part.step;  // left
    const int step = part.step * (over ? (beams + kBeams - 1) / kBeams : 1);
    const int end = over ? part.end : std::min(part.end, first + kBeams * part.step);
    integrate_scan(model_, caster, writer, ScanPart(part.scan, first, end, step), params_.free_no_return_m);
  }
  return !over;
}

void Lslam::count(const AncestryGrid::Counters& before, std::int64_t thinned_before, UpdateReport& report) {
  report.refused_tiles = particles_.grid().counters().refused_tiles - before.refused_tiles;
  report.outside_tiles = particles_.grid().counters().outside_tiles - before.outside_tiles;
  report.thinned_poses = particles_.paths().thinned() - thinned_before;
  pool_was_full_ = report.refused_tiles > 0;
}

}  // namespace odoless
