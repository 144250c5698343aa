#include "tests/support/plain_particles.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <tuple>

#include "core/slam/particle_weights.hpp"

namespace odoless {
namespace {

/// Lslam's grid ends at a border of its tiles of 16 cells.
int whole_tiles_cells(double extent_cells) { return 16 * static_cast<int>(std::ceil(extent_cells / 16.0 - 1e-9)); }

}  // namespace

void PlainMap::move(const GridGeometry& window) {
  window_ = window;
  std::erase_if(cells_, [this](const auto& cell) { return !has(cell.first.first, cell.first.second); });
}

bool PlainMap::has(int column, int row) const {
  return column >= window_.first_column && column < window_.first_column + window_.columns &&
         row >= window_.first_row && row < window_.first_row + window_.rows;
}

Cell& PlainMap::at(const GridCell& cell) {
  if (has(cell.column(), cell.row())) {
    return cells_[{cell.column(), cell.row()}];
  }
  outside_ = Cell{};
  return outside_;
}

PlainParticles::PlainParticles(const LslamParams& params, std::uint64_t seed)
    : params_(params),
      grid_{.resolution_m = params.grid.resolution_m,
            .columns = whole_tiles_cells(params.grid.width_m / params.grid.resolution_m),
            .rows = whole_tiles_cells(params.grid.height_m / params.grid.resolution_m)},
      motion_(params.motion),
      model_(params.beam, params.grid.resolution_m),
      rng_(seed),
      wanted_particles_(static_cast<std::size_t>(params.particles)) {
  particles_.push_back(Particle{{}, 0.0, PlainMap(grid_), {}, {}});
}

void PlainParticles::update(const Motion& motion, const ScanFrame& scan) {
  std::vector<int> copies(particles_.size(), static_cast<int>(wanted_particles_));
  resampled_ = true;
  if (started_) {
    const double lambda_m = speed_.lambda_m(motion);
    for (Particle& particle : particles_) {
      const Pose2 map_T_tracked = particle.map_T_scan * particle.error.pose().inverse();
      particle.error.advance(motion.error(), root_of(motion.error().noise), rng_);
      const Pose2& step = motion.alternative_count > 0 ? motion.at_share(rng_.uniform()) : motion.previous_T_current;
      particle.map_T_scan = motion_.sample(map_T_tracked, step, lambda_m, rng_) * particle.error.pose();
    }
    speed_.add(motion);
    std::vector<Beam> beams;
    select_beams(scan, params_.beams_used, params_.weigh_no_return, beams);
    std::vector<double> log_weights;
    for (Particle& particle : particles_) {
      weigh(particle, beams);
      log_weights.push_back(particle.log_weight);
    }
    normalise_weights(log_weights, weights_);
    resampled_ = effective_particles(weights_) < params_.resample_below * static_cast<double>(particles_.size()) ||
                 wanted_particles_ < particles_.size();
    if (resampled_) {
      systematic_copies(weights_, static_cast<int>(needed()), rng_.uniform(), copies);
    }
  }
  if (started_) {
    follow();
  }
  ++updates_;
  for (Particle& particle : particles_) {
    map_scan(particle, scan);
  }
  if (resampled_) {
    resample(copies);
  }
  started_ = true;
}

/// As many as Fox's equation asks for, of the bins that hold particles of half the mean weight at least.
std::size_t PlainParticles::needed() const {
  if (params_.spread_error == 0.0) {
    return wanted_particles_;
  }
  std::set<std::tuple<double, double, double>> bins;
  for (std::size_t i = 0; i < particles_.size(); ++i) {
    if (weights_[i] >= 0.5 / static_cast<double>(particles_.size())) {
      const Pose2& pose = particles_[i].map_T_scan;
      constexpr double kSide_rad = 2.0 * std::numbers::pi / 180.0;
      bins.emplace(std::floor(pose.x_m / 0.1), std::floor(pose.y_m / 0.1), std::floor(pose.yaw_rad / kSide_rad));
    }
  }
  const double free = static_cast<double>(bins.size()) - 1.0;
  const double root = 1.0 - 2.0 / (9.0 * free) + std::sqrt(2.0 / (9.0 * free)) * 2.326;
  const double needed = free < 1.0 ? 1.0 : std::ceil(free / (2.0 * params_.spread_error) * root * root * root);
  return std::min(static_cast<std::size_t>(std::max<double>(needed, params_.particles_min)), wanted_particles_);
}

void PlainParticles::weigh(Particle& particle, const std::vector<Beam>& beams) const {
  const auto score = [&](const Pose2& map_T_scan) {
    return log_likelihood(model_, BeamCaster(grid_, map_T_scan), particle.map, beams, 1.0 / grid_.resolution_m);
  };
  if (!beams.empty()) {
    const ScoredPose found =
        climb(particle.map_T_scan, params_.refine_step_m, params_.refine_step_rad, params_.refine_steps, score);
    particle.map_T_scan = found.pose;
    particle.log_weight += params_.tempering * found.score;
  }
}

void PlainParticles::follow() {
  const auto heaviest = std::max_element(weights_.begin(), weights_.end()) - weights_.begin();
  const Pose2& pose = particles_[static_cast<std::size_t>(heaviest)].map_T_scan;
  const auto moved = [](double cell, int first, int cells) {
    const double from_first = std::floor(cell) - first;
    return first + (from_first < 0.25 * cells ? -16 : from_first >= 0.75 * cells ? 16 : 0);
  };
  const Point2 cell = grid_.cells(pose.x_m, pose.y_m);
  grid_.first_column = moved(cell.x_m, grid_.first_column, grid_.columns);
  grid_.first_row = moved(cell.y_m, grid_.first_row, grid_.rows);
  for (Particle& particle : particles_) {
    particle.map.move(grid_);
  }
}

void PlainParticles::map_scan(Particle& particle, const ScanFrame& scan) const {
  const int step = (scan.size() + params_.beams_mapped - 1) / params_.beams_mapped;
  integrate_scan(model_, BeamCaster(grid_, particle.map_T_scan), particle.map,
                 ScanPart(scan, updates_ % step, scan.size(), step), params_.free_no_return_m);
  particle.path.push_back({.stamp_ns = scan.stamp_ns(), .map_T_scan = particle.map_T_scan});
}

void PlainParticles::resample(const std::vector<int>& copies) {
  std::vector<Particle> next;
  for (std::size_t i = 0; i < copies.size(); ++i) {
    particles_[i].log_weight = 0.0;
    next.insert(next.end(), static_cast<std::size_t>(copies[i]), particles_[i]);
  }
  particles_ = std::move(next);
  weights_.assign(particles_.size(), 1.0 / static_cast<double>(particles_.size()));
}

}  // namespace odoless
