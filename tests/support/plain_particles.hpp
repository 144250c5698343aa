#pragma once

#include <map>
#include <utility>
#include <vector>

#include "core/slam/lslam.hpp"

namespace odoless {

/// A map of its own: every cell by its column and row, copied as a whole.
class PlainMap {
 public:
  explicit PlainMap(const GridGeometry& window) : window_(window) {}

  /// Forgets what this window lacks.
  void move(const GridGeometry& window);
  /// Outside of the window: a cell that is always unknown when read, and takes what is written.
  [[nodiscard]] Cell& at(const GridCell& cell);

 private:
  [[nodiscard]] bool has(int column, int row) const;

  GridGeometry window_;
  std::map<std::pair<int, int>, Cell> cells_;
  Cell outside_;
};

/// Lslam with neither ancestry nor shared grid nor pools: each particle owns its map and its path, and copies both when
/// it is resampled. The oracle for Lslam: the same seed must give the same bits.
class PlainParticles {
 public:
  PlainParticles(const LslamParams& params, std::uint64_t seed);

  void set_particles(int wanted) { wanted_particles_ = static_cast<std::size_t>(wanted); }
  void update(const Motion& motion, const ScanFrame& scan);

  struct Particle {
    Pose2 map_T_scan;
    double log_weight = 0.0;
    PlainMap map;
    std::vector<StampedPose> path;
    DrawnError error{};
  };

  [[nodiscard]] std::vector<Particle>& particles() { return particles_; }
  [[nodiscard]] const std::vector<double>& weights() const { return weights_; }
  [[nodiscard]] bool resampled() const { return resampled_; }

 private:
  [[nodiscard]] std::size_t needed() const;
  void weigh(Particle& particle, const std::vector<Beam>& beams) const;
  void map_scan(Particle& particle, const ScanFrame& scan) const;
  /// Where the heaviest particle is not in the middle half of the window, this moves by a tile.
  void follow();
  void resample(const std::vector<int>& copies);

  LslamParams params_;
  GridGeometry grid_;
  ScanMatchingMotionModel motion_;
  BeamModel model_;
  TravelSpeed speed_;
  Rng rng_;
  std::vector<Particle> particles_;
  std::vector<double> weights_;
  std::size_t wanted_particles_;
  int updates_ = 0;
  bool started_ = false;
  bool resampled_ = false;
};

}  // namespace odoless
