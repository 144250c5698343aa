#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "core/geometry/pose2.hpp"

namespace odoless {

/// KLD sampling [fox2003adapting; method 7]: how many particles their spread needs. Few do while the robot knows where
/// it is, and many where the posterior is wide.
///
/// Thread:    owned by one thread.
/// Real time: no allocation after construction; n log n in the particles.
class KldSampling {
 public:
  explicit KldSampling(int particles_max);

  /// Bins of 0.1 m, 0.1 m and 2 deg that hold particles which a resampling would rather keep than drop.
  /// @param weights  Of sum 1, one for each pose.
  [[nodiscard]] int bins(std::span<const Pose2> poses, std::span<const double> weights);

  /// Particles that leave a Kullback-Leibler distance of at most `error` between a posterior over `bins` bins and their
  /// distribution, with a probability of 0.99 (equation 7 of Fox's paper). At least 1; `error` above 0.
  [[nodiscard]] static int particles_for(int bins, double error);

 private:
  using Key = std::array<int, 3>;

  std::vector<Key> keys_;  ///< as many as there can be particles: a copy has room too
};

}  // namespace odoless
