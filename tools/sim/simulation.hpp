#pragma once

#include <cstdint>
#include <iosfwd>

#include "tools/sim/simulated_lrf.hpp"
#include "tools/sim/world.hpp"

namespace odoless {

struct SimulationSummary {
  std::int64_t scans = 0;
  double duration_s = 0.0;
  double length_m = 0.0;
};

/// Drives the path of `world` and writes one scan per period, from the path's start (stamp 0) to its end.
///
/// @param log    CARMEN log: FLASER where the laser fits its convention, else ROBOTLASER1; odometry and poses are 0.
/// @param truth  The true poses world_T_robot at the scans' stamps, a TUM line each: stamp x y z and a unit quaternion.
[[nodiscard]] SimulationSummary simulate(const World& world, SimulatedLrf& lrf, std::ostream& log, std::ostream& truth);

}  // namespace odoless
