#pragma once

#include <cstdint>
#include <numbers>
#include <vector>

#include "core/base/parameters.hpp"
#include "core/cloud/tilt_mount.hpp"
#include "core/geometry/stamped_pose.hpp"
#include "tools/log/tilt_log.hpp"
#include "tools/sim/simulated_lrf.hpp"
#include "tools/sim/world.hpp"

namespace odoless {

/// What the simulated servo does: it goes from end to end and back without a rest (nodding), or rests level and then
/// makes one sweep over both ends and back to level (full sweeps).
struct TiltMotionParams {
  double from_rad = -std::numbers::pi / 6.0;
  double to_rad = std::numbers::pi / 4.0;
  double speed_radps = std::numbers::pi;
  double level_rest_s = 0.0;
  double angle_rate_hz = 100.0;
  double clock_ahead_s = 0.0;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    constexpr double kQuarterRad = std::numbers::pi / 2.0;
    visit.value("from_rad", self.from_rad, Range{-kQuarterRad, 0.0}, "Upper end of the sweep (negative looks up).");
    visit.value("to_rad", self.to_rad, Range{0.0, kQuarterRad}, "Lower end of the sweep.");
    visit.value("speed_radps", self.speed_radps, Range{0.01, 100.0}, "Of the tilt axis.");
    visit.value("level_rest_s", self.level_rest_s, Range{0.0, 1000.0},
                "Rest at the level pose between two sweeps; 0: it nods without a rest.");
    visit.value("angle_rate_hz", self.angle_rate_hz, Range{1.0, 10'000.0}, "Angles that are measured per second.");
    visit.value("clock_ahead_s", self.clock_ahead_s, Range{-10.0, 10.0}, "How far the servo's clock is ahead.");
  }
};

/// The tilt angle at a time.
[[nodiscard]] double simulated_tilt_rad(const TiltMotionParams& params, double time_s);

/// A laser on a tilt servo on its way through a building.
struct TiltedSimulation {
  TiltLog log;
  std::vector<StampedPose> truth;  ///< world_T_scan of the level laser at the scans' stamps
};

/// Drives the path of `world`, each beam at its own time, pose and tilt angle, from the path's start (stamp 0) to its
/// end. The same arguments give the same log.
[[nodiscard]] TiltedSimulation simulate_tilted(const World& world, const TiltMount& mount,
                                               const SimulatedLrfParams& lrf, const TiltMotionParams& tilt,
                                               std::uint64_t seed);

}  // namespace odoless
