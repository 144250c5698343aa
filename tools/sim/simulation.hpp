#pragma once

#include <cstdint>
#include <string>

#include "tools/sim/simulated_lrf.hpp"
#include "tools/sim/world.hpp"

namespace odoless {

/// A recorded drive through a world.
struct Simulation {
  std::string log;  ///< CARMEN: FLASER where the laser fits its convention, else ROBOTLASER1; odometry and poses are 0
  std::string truth;  ///< world_T_robot at the scans' stamps, a TUM line each: stamp x y z and a unit quaternion
  int scans = 0;
  double duration_s = 0.0;
  double length_m = 0.0;
};

/// Drives the path of `world` and takes one scan per period, from the path's start (stamp 0) to its end.
/// The same world, parameters and seed give the same bytes.
[[nodiscard]] Simulation simulate(const World& world, const SimulatedLrfParams& params, std::uint64_t seed);

}  // namespace odoless
