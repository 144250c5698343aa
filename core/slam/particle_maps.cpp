#include "core/slam/particle_maps.hpp"

#include <algorithm>
#include <iterator>
#include <numeric>

#include "core/base/check.hpp"
#include "core/slam/particle_weights.hpp"

namespace odoless {

ParticleMaps::ParticleMaps(const AncestryGridParams& grid, int particles_max, int path_records_max, int steps_max)
    : grid_(grid, particles_max),
      paths_(std::max(path_records_max, 16 * steps_max * particles_max), particles_max, steps_max) {
  const auto particles = static_cast<std::size_t>(particles_max);
  poses_.resize(particles);
  old_poses_.resize(particles);
  log_weights_.resize(particles);
  weights_.resize(particles);
  copies_.resize(particles);
  scratch_.resize(particles);
  reset({});
}

void ParticleMaps::reset(const Pose2& map_T_scan) {
  grid_.reset();
  paths_.reset();
  poses_[0] = map_T_scan;
  log_weights_[0] = 0.0;
  weights_[0] = 1.0;
  best_ = 0;
}

void ParticleMaps::set_pose(const Pose2& map_T_scan, const PoseSpread& spread, Rng& rng) {
  std::fill(poses_.begin(), poses_.end(), map_T_scan);
  if (spread.sd_m > 0.0 || spread.sd_rad > 0.0) {
    for (Pose2& pose : living(poses_)) {
      const double x_m = spread.sd_m * rng.normal();
      const double y_m = spread.sd_m * rng.normal();
      pose = map_T_scan * Pose2{x_m, y_m, spread.sd_rad * rng.normal()};
    }
  }
}

double ParticleMaps::effective() const {
  return effective_particles(std::span(weights_).first(static_cast<std::size_t>(size())));
}

void ParticleMaps::normalise() {
  normalise_weights(living(log_weights_), living(weights_));
  const std::span<const double> weights = living(weights_);
  best_ = static_cast<int>(std::distance(weights.begin(), std::max_element(weights.begin(), weights.end())));
}

void ParticleMaps::choose_survivors(int wanted, bool drop_weakest_half, Rng& rng) {
  ODOLESS_CHECK(wanted >= 1 && wanted <= capacity());
  if (drop_weakest_half) {
    odoless::drop_weakest_half(living(weights_), living(scratch_));
  }
  systematic_copies(living(weights_), wanted, rng.uniform(), living(copies_));
}

void ParticleMaps::spread_the_first(int wanted) {
  ODOLESS_CHECK(size() == 1 && wanted >= 1 && wanted <= capacity());
  copies_[0] = wanted;
}

void ParticleMaps::retain() {
  grid_.retain(living(copies_));
  paths_.retain(living(copies_));
}

void ParticleMaps::multiply() {
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
  best_ = std::min(best_, static_cast<int>(next) - 1);
  grid_.branch(copies);
  paths_.branch(copies);
  std::fill(log_weights_.begin(), log_weights_.end(), 0.0);
  std::fill(weights_.begin(), weights_.end(), 1.0 / static_cast<double>(next));
}

}  // namespace odoless
