#pragma once

#include <cstdint>

#include "config/robot_params.hpp"
#include "core/odometry/laser_odometry.hpp"

namespace odoless {

/// Scans in, motion out: the matcher thread's work, one scan at a time.
///
/// Thread: matcher thread, or the one thread of a replay. Real time: no allocation after construction; bounded by the
/// matcher's evaluations and, if given, the deadline.
class MatcherStage {
 public:
  MatcherStage(const RobotParams& params, std::uint64_t seed);

  /// Deskews `scan`, where it tells its beams' times; the filter wants it like that too.
  [[nodiscard]] Motion process(ScanFrame& scan, const Deadline& deadline = {});

 private:
  LaserOdometry odometry_;
  Rng rng_;
};

}  // namespace odoless
