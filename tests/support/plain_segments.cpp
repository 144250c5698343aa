#include "tests/support/plain_segments.hpp"

#include <Eigen/Cholesky>

#include "core/slam/particle_weights.hpp"
#include "core/slam/pose_search.hpp"

namespace odoless {

PlainSegments::PlainSegments(const HslamParams& params, std::uint64_t seed)
    : params_(params),
      grid_(AncestryGrid(params.grid, 1).geometry()),
      model_(params.beam, params.grid.resolution_m),
      rng_(seed, 2) {
  particles_.push_back(Particle{{}, 0.0, PlainMap(grid_), {}});
}

void PlainSegments::add(const RunSegment& segment) {
  std::vector<int> copies(particles_.size(), params_.particles);
  bool resampled = !started_;
  const Eigen::Matrix3d covariance = segment.drift_covariance() + 1e-12 * Eigen::Matrix3d::Identity();
  const Eigen::Matrix3d drift_root = Eigen::LLT<Eigen::Matrix3d>(covariance).matrixL();
  for (Particle& particle : particles_) {
    move_and_weigh(particle, segment, drift_root);
  }
  if (started_) {
    std::vector<double> log_weights;
    for (const Particle& particle : particles_) {
      log_weights.push_back(particle.log_weight);
    }
    normalise_weights(log_weights, weights_);
    resampled = effective_particles(weights_) < params_.resample_below * static_cast<double>(particles_.size());
    if (resampled) {
      systematic_copies(weights_, params_.particles, rng_.uniform(), copies);
    }
  }
  for (Particle& particle : particles_) {
    map(particle, segment);
  }
  if (resampled) {
    std::vector<Particle> next;
    for (std::size_t i = 0; i < copies.size(); ++i) {
      particles_[i].log_weight = 0.0;
      next.insert(next.end(), static_cast<std::size_t>(copies[i]), particles_[i]);
    }
    particles_ = std::move(next);
    weights_.assign(particles_.size(), 1.0 / static_cast<double>(particles_.size()));
  }
  resamplings_ += resampled ? 1 : 0;
  started_ = true;
}

void PlainSegments::move_and_weigh(Particle& particle, const RunSegment& segment, const Eigen::Matrix3d& drift_root) {
  double left = rng_.uniform();
  particle.drift.setZero();
  particle.segment_path = segment.paths() - 1;
  for (int path = segment.paths() - 1; path >= 0; --path) {
    double before = 0.0;
    for (int i = 0; i <= path; ++i) {
      before += segment.path_weight(i);
    }
    particle.segment_path = left < before ? path : particle.segment_path;
  }
  if (!started_) {
    return;
  }
  const double factor = rng_.uniform() < params_.wide_share ? params_.wide_factor : 1.0;
  Pose2 drawn;
  drawn.x_m = factor * rng_.normal();
  drawn.y_m = factor * rng_.normal();
  drawn.yaw_rad = factor * rng_.normal();
  const auto posterior = [&](const Pose2& deviations) {
    const Eigen::Vector3d z(deviations.x_m, deviations.y_m, deviations.yaw_rad);
    const Eigen::Vector3d drift = drift_root * z;
    const int count = std::min(params_.scans_weighed, segment.size());
    double sum = 0.0;
    for (int i = 0; i < count; ++i) {
      const int scan = (i + 1) * segment.size() / count - 1;
      std::vector<Beam> beams;
      select_beams(segment.scan(scan), params_.beams_used, false, beams);
      const Pose2 map_T_scan = particle.map_T_scan * segment.scan_pose(particle.segment_path, scan, drift);
      sum += log_likelihood(model_, BeamCaster(grid_, map_T_scan), particle.map, beams, 1.0 / grid_.resolution_m);
    }
    return params_.tempering * sum - 0.5 * z.squaredNorm();
  };
  const ScoredPose found = climb(drawn, params_.refine_step, params_.refine_step, params_.refine_steps, posterior);
  particle.drift = drift_root * Eigen::Vector3d(found.pose.x_m, found.pose.y_m, found.pose.yaw_rad);
  particle.log_weight += found.score;
}

void PlainSegments::map(Particle& particle, const RunSegment& segment) const {
  const Pose2 map_T_start = particle.map_T_scan;
  for (int i = 0; i < segment.size(); ++i) {
    particle.map_T_scan = map_T_start * segment.scan_pose(particle.segment_path, i, particle.drift);
    const ScanFrame& scan = segment.scan(i);
    integrate_scan(model_, BeamCaster(grid_, particle.map_T_scan), particle.map, scan, params_.free_no_return_m);
    particle.path.push_back({.stamp_ns = scan.stamp_ns(), .map_T_scan = particle.map_T_scan});
  }
}

}  // namespace odoless
