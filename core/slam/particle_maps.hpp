#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include "core/base/rng.hpp"
#include "core/geometry/pose2.hpp"
#include "core/grid/ancestry_grid.hpp"
#include "core/slam/kld_sampling.hpp"
#include "core/slam/path_pool.hpp"

namespace odoless {

/// Deviations of poses around one.
struct PoseSpread {
  double sd_m = 0.0;
  double sd_rad = 0.0;
};

/// Particles of pose, weight, map and path: what both levels of the filter are made of [eliazar2003dpslam; method 6].
///
/// A step of a filter moves the poses, adds to the log-weights, calls `normalise`, then either leaves it at that or
/// chooses survivors. Scans are put into maps once per survivor, before these multiply: between `retain` and
/// `multiply`, poses, maps and paths of particles that did not survive must not be asked for.
///
/// Thread:    owned by one thread.
/// Real time: no allocation after construction; all but maps and paths is linear in the particles.
class ParticleMaps {
 public:
  /// @param steps_max  Most poses that a path grows by between two calls of `next_step`; the pool of paths has room for
  ///                   at least 16 times as many per particle.
  ParticleMaps(const AncestryGridParams& grid, int particles_max, int path_records_max, int steps_max = 1);

  /// One particle at this pose, nothing observed.
  void reset(const Pose2& map_T_scan);
  /// Puts every particle here, give or take the spread; weights, maps and paths stay. Draws nothing without a spread.
  void set_pose(const Pose2& map_T_scan, const PoseSpread& spread, Rng& rng);

  [[nodiscard]] int size() const { return grid_.tree().particles(); }
  [[nodiscard]] int capacity() const { return static_cast<int>(poses_.size()); }
  [[nodiscard]] Pose2& pose(int particle) { return poses_[static_cast<std::size_t>(particle)]; }
  [[nodiscard]] const Pose2& pose(int particle) const { return poses_[static_cast<std::size_t>(particle)]; }
  /// Of sum 1, as the last `normalise` or `multiply` left them.
  [[nodiscard]] double weight(int particle) const { return weights_[static_cast<std::size_t>(particle)]; }
  /// The heaviest; just after a resampling a copy of it.
  [[nodiscard]] int best() const { return best_; }
  [[nodiscard]] double effective() const;
  /// KldSampling::bins of these particles.
  [[nodiscard]] int bins(KldSampling& kld) const {
    const auto particles = static_cast<std::size_t>(size());
    return kld.bins(std::span(poses_).first(particles), std::span(weights_).first(particles));
  }

  void add_log_weight(int particle, double log_likelihood) {
    log_weights_[static_cast<std::size_t>(particle)] += log_likelihood;
  }
  /// This one and all after it get the weight 0 with the next `normalise`; for survivors to be chosen after it.
  void give_up_from(int particle) {
    std::fill(log_weights_.begin() + particle, log_weights_.begin() + size(), -std::numeric_limits<double>::infinity());
  }
  void normalise();

  /// Decides how often each particle goes on, by a systematic resampling to `wanted` particles.
  void choose_survivors(int wanted, bool drop_weakest_half, Rng& rng);
  /// The only particle goes on `wanted` times.
  void spread_the_first(int wanted);
  /// Takes the maps and paths of the particles that do not go on.
  void retain();
  [[nodiscard]] bool survives(int particle) const { return copies_[static_cast<std::size_t>(particle)] > 0; }
  /// Copies what another keeps of the particles as `multiply` will copy the particles; before it.
  template <class Value>
  void multiply_alike(const std::vector<Value>& from, std::vector<Value>& to) const {
    std::size_t next = 0;
    for (std::size_t i = 0; i < static_cast<std::size_t>(size()); ++i) {
      std::fill_n(to.begin() + static_cast<std::ptrdiff_t>(next), copies_[i], from[i]);
      next += static_cast<std::size_t>(copies_[i]);
    }
  }
  /// Replaces every survivor by its copies, all of the same weight.
  void multiply();

  /// Begins a step: makes room for the paths to grow.
  void next_step() { paths_.next_update(); }
  [[nodiscard]] AncestryGrid& grid() { return grid_; }
  [[nodiscard]] const AncestryGrid& grid() const { return grid_; }
  [[nodiscard]] PathPool& paths() { return paths_; }
  [[nodiscard]] const PathPool& paths() const { return paths_; }

 private:
  template <class Value>
  [[nodiscard]] std::span<Value> living(std::vector<Value>& values) const {
    return std::span(values).first(static_cast<std::size_t>(size()));
  }

  AncestryGrid grid_;
  PathPool paths_;
  std::vector<Pose2> poses_;
  std::vector<Pose2> old_poses_;
  std::vector<double> log_weights_;
  std::vector<double> weights_;
  std::vector<int> copies_;
  std::vector<int> scratch_;
  int best_ = 0;
};

}  // namespace odoless
