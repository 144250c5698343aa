#include "core/slam/hslam.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "core/base/check.hpp"
#include "core/slam/pose_search.hpp"

namespace odoless {

Hslam::Hslam(const HslamParams& params, std::uint64_t seed)
    : params_(params),
      model_(params.beam, params.grid.resolution_m),
      particles_(params.grid, params.particles, params.path_records_max, params.segment_updates),
      rng_(seed, 2),
      motions_(static_cast<std::size_t>(params.particles)),
      scores_(static_cast<std::size_t>(params.particles)),
      beams_(static_cast<std::size_t>(params.scans_weighed)) {
  ODOLESS_CHECK(parameters_in_range(params));
  for (std::vector<Beam>& beams : beams_) {
    beams.reserve(static_cast<std::size_t>(params.beams_used));
  }
  scans_weighed_.reserve(beams_.size());
  reset({});
}

void Hslam::reset(const Pose2& map_T_scan) {
  particles_.reset(map_T_scan);
  best_pose_ = map_T_scan;
  phase_ = Phase::kIdle;
  report_ = SegmentReport{};
  started_ = pool_was_full_ = false;
}

void Hslam::set_pose(const Pose2& map_T_scan, const PoseSpread& spread) {
  ODOLESS_CHECK(idle());
  particles_.set_pose(map_T_scan, spread, rng_);
  best_pose_ = map_T_scan;
}

void Hslam::begin(const RunSegment& segment) {
  ODOLESS_CHECK(idle() && segment.paths() > 0);
  segment_ = &segment;
  before_ = particles_.grid().counters();
  drift_root_ = Eigen::LLT<Eigen::Matrix3d>(segment.drift_covariance() + 1e-12 * Eigen::Matrix3d::Identity()).matrixL();
  pick_scans();
  next_ = 0;
  phase_ = Phase::kWeigh;
}

bool Hslam::work(int particles) {
  for (; particles > 0 && !idle(); --particles) {
    if (phase_ == Phase::kWeigh) {
      weigh(next_++);
      phase_ = next_ == particles_.size() ? Phase::kChoose : phase_;
    } else if (phase_ == Phase::kChoose) {
      choose();
      next_ = 0;
      phase_ = Phase::kMap;
    } else {
      map(next_++);
      if (next_ == particles_.size()) {
        finish();
        return true;
      }
    }
  }
  return false;
}

void Hslam::pick_scans() {
  scans_weighed_.clear();
  beams_weighed_ = 0;
  const int count = std::min(params_.scans_weighed, segment_->size());
  for (int i = 0; i < count; ++i) {
    const int scan = (i + 1) * segment_->size() / count - 1;
    std::vector<Beam>& beams = beams_[static_cast<std::size_t>(i)];
    select_beams(segment_->scan(scan), params_.beams_used, false, beams);
    scans_weighed_.push_back(scan);
    beams_weighed_ += static_cast<int>(beams.size());
  }
}

int Hslam::draw_path() {
  double left = rng_.uniform();
  for (int path = 0; path < segment_->paths(); ++path) {
    left -= segment_->path_weight(path);
    if (left < 0.0) {
      return path;
    }
  }
  return segment_->paths() - 1;
}

/// The search goes over the drift in units of its deviations, so that one step fits all directions.
void Hslam::weigh(int particle) {
  const auto i = static_cast<std::size_t>(particle);
  Motion& motion = motions_[i];
  motion = {draw_path(), Eigen::Vector3d::Zero()};
  scores_[i] = 0.0;
  if (!started_) {
    return;
  }
  const double factor = rng_.uniform() < params_.wide_share ? params_.wide_factor : 1.0;
  const Pose2 drawn{factor * rng_.normal(), factor * rng_.normal(), factor * rng_.normal()};
  const auto posterior = [&](const Pose2& deviations) {
    const Eigen::Vector3d z(deviations.x_m, deviations.y_m, deviations.yaw_rad);
    motion.drift = drift_root_ * z;
    return params_.tempering * log_likelihood_of(particle, motion) - 0.5 * z.squaredNorm();
  };
  const ScoredPose found = climb(drawn, params_.refine_step, params_.refine_step, params_.refine_steps, posterior);
  const Eigen::Vector3d z(found.pose.x_m, found.pose.y_m, found.pose.yaw_rad);
  motion.drift = drift_root_ * z;
  scores_[i] = (found.score + 0.5 * z.squaredNorm()) / params_.tempering;
  particles_.add_log_weight(particle, params_.refine_steps > 0 ? found.score : params_.tempering * scores_[i]);
}

double Hslam::log_likelihood_of(int particle, const Motion& motion) {
  AncestryGrid::View view = particles_.grid().view(particle);
  const GridGeometry& geometry = particles_.grid().geometry();
  const double cells_per_m = 1.0 / geometry.resolution_m;
  double sum = 0.0;
  for (std::size_t i = 0; i < scans_weighed_.size(); ++i) {
    const Pose2 map_T_scan =
        particles_.pose(particle) * segment_->scan_pose(motion.path, scans_weighed_[i], motion.drift);
    sum += log_likelihood(model_, BeamCaster(geometry, map_T_scan), view, beams_[i], cells_per_m);
  }
  return sum;
}

void Hslam::choose() {
  particles_.next_step();
  if (started_) {
    particles_.normalise();
    report_.effective_particles = particles_.effective();
    report_.log_likelihood_per_beam =
        scores_[static_cast<std::size_t>(particles_.best())] / std::max(1, beams_weighed_);
    report_.resampled = pool_was_full_ || report_.effective_particles < params_.resample_below * particles_.size();
    if (report_.resampled) {
      particles_.choose_survivors(params_.particles, pool_was_full_, rng_);
    }
  } else {
    particles_.spread_the_first(params_.particles);
    report_.effective_particles = 1.0;
    report_.resampled = true;
  }
  if (report_.resampled) {
    particles_.retain();
  }
}

void Hslam::map(int particle) {
  if (report_.resampled && !particles_.survives(particle)) {
    return;
  }
  const Motion& motion = motions_[static_cast<std::size_t>(particle)];
  Pose2& pose = particles_.pose(particle);
  const Pose2 map_T_start = pose;
  AncestryGrid::Writer writer = particles_.grid().writer(particle);
  for (int i = 0; i < segment_->size(); ++i) {
    pose = map_T_start * segment_->scan_pose(motion.path, i, motion.drift);
    const ScanFrame& scan = segment_->scan(i);
    integrate_scan(model_, BeamCaster(particles_.grid().geometry(), pose), writer, scan, params_.free_no_return_m);
    particles_.paths().append(particle, {.stamp_ns = scan.stamp_ns(), .map_T_scan = pose});
  }
}

void Hslam::finish() {
  if (report_.resampled) {
    particles_.multiply();
  }
  const AncestryGrid::Counters& now = particles_.grid().counters();
  report_.refused_tiles = now.refused_tiles - before_.refused_tiles;
  report_.outside_tiles = now.outside_tiles - before_.outside_tiles;
  pool_was_full_ = report_.refused_tiles > 0;
  ++report_.segments;
  best_pose_ = particles_.pose(particles_.best());
  started_ = true;
  phase_ = Phase::kIdle;
  segment_ = nullptr;
}

}  // namespace odoless
