#pragma once

#include <vector>

#include "core/slam/hslam.hpp"
#include "tests/support/plain_particles.hpp"

namespace odoless {

/// Hslam at one go, with neither ancestry nor shared grid nor pools: each particle owns its map and its path. The
/// oracle for Hslam: the same seed must give the same bits.
class PlainSegments {
 public:
  PlainSegments(const HslamParams& params, std::uint64_t seed);

  void add(const RunSegment& segment);

  struct Particle {
    Pose2 map_T_scan;
    double log_weight = 0.0;
    PlainMap map;
    std::vector<StampedPose> path;
    int segment_path = 0;
    Eigen::Vector3d drift = Eigen::Vector3d::Zero();
  };
  [[nodiscard]] std::vector<Particle>& particles() { return particles_; }
  [[nodiscard]] const std::vector<double>& weights() const { return weights_; }
  [[nodiscard]] int resamplings() const { return resamplings_; }

 private:
  void move_and_weigh(Particle& particle, const RunSegment& segment, const Eigen::Matrix3d& drift_root);
  void map(Particle& particle, const RunSegment& segment) const;

  HslamParams params_;
  GridGeometry grid_;
  BeamModel model_;
  Rng rng_;
  std::vector<Particle> particles_;
  std::vector<double> weights_;
  bool started_ = false;
  int resamplings_ = 0;
};

}  // namespace odoless
