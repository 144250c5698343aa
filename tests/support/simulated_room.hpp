#pragma once

#include <vector>

#include "core/base/rng.hpp"
#include "core/geometry/pose2.hpp"
#include "core/motion/motion.hpp"
#include "core/scan/scan_frame.hpp"

namespace odoless {

/// A robot that wanders through a rectangular room with a pillar, seen by a laser with noise, drop-outs and
/// no-returns; for tests that need a run and not a world.
class SimulatedRoom {
 public:
  explicit SimulatedRoom(std::uint64_t seed, int beams = 60);

  /// Moves the robot one step, after the first call, and sweeps the laser.
  void step();

  [[nodiscard]] const ScanFrame& scan() const { return scan_; }
  /// What a matcher might have said of the last step: the truth with some error.
  [[nodiscard]] const Motion& motion() const { return motion_; }
  /// Truth; the run starts at zero.
  [[nodiscard]] const Pose2& map_T_scan() const { return map_T_scan_; }

 private:
  [[nodiscard]] float range_m(double angle_rad);
  void sweep();

  Rng rng_;
  int beams_;
  ScanFrame scan_;
  std::vector<float> ranges_m_;
  Pose2 map_T_scan_;
  Motion motion_;
  int steps_ = 0;
};

}  // namespace odoless
