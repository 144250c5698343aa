#include "tools/sim/simulation.hpp"

#include <fmt/format.h>

#include <cmath>

#include "core/math/elementary.hpp"
#include "tools/sim/carmen_writer.hpp"
#include "tools/sim/path.hpp"

namespace odoless {
namespace {

std::string tum_line(double stamp_s, const Pose2& world_T_robot) {
  return fmt::format("{:.6f} {:.9f} {:.9f} 0 0 0 {:.9f} {:.9f}\n", stamp_s, world_T_robot.x_m, world_T_robot.y_m,
                     math::sin(world_T_robot.yaw_rad / 2.0), math::cos(world_T_robot.yaw_rad / 2.0));
}

}  // namespace

Simulation simulate(const World& world, const SimulatedLrfParams& params, std::uint64_t seed) {
  const Path path(world.waypoints);
  SimulatedLrf lrf(params, seed);
  const double period_ns = 1e9 / params.rate_hz;
  Simulation simulation{.log = {}, .truth = {}, .duration_s = path.duration_s(), .length_m = path.length_m()};
  while (true) {
    const std::int64_t stamp_ns = std::llround(simulation.scans * period_ns);
    const double stamp_s = static_cast<double>(stamp_ns) * 1e-9;
    if (stamp_s > path.duration_s()) {
      return simulation;
    }
    simulation.log += carmen_line(lrf, lrf.sweep(world, path, stamp_s), stamp_ns);
    simulation.truth += tum_line(stamp_s, path.at(stamp_s));
    ++simulation.scans;
  }
}

}  // namespace odoless
