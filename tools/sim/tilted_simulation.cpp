#include "tools/sim/tilted_simulation.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/float_precision.hpp"
#include "tools/sim/path.hpp"

namespace odoless {
namespace {

/// The whole microseconds that a log can hold.
std::int64_t stamp_ns_of(double time_s) { return std::llround(time_s * 1e6) * 1000; }

void add_angles(const TiltMotionParams& tilt, double duration_s, TiltLog& log) {
  for (int i = 0; i / tilt.angle_rate_hz <= duration_s + 1.0; ++i) {
    const double time_s = static_cast<double>(stamp_ns_of(i / tilt.angle_rate_hz)) * 1e-9;
    log.angles.push_back({stamp_ns_of(time_s + tilt.clock_ahead_s), simulated_tilt_rad(tilt, time_s)});
  }
}

}  // namespace

double simulated_tilt_rad(const TiltMotionParams& params, double time_s) {
  const double down_s = params.to_rad / params.speed_radps;
  const double up_s = -params.from_rad / params.speed_radps;
  const double period_s = params.level_rest_s + 2.0 * (down_s + up_s);
  if (period_s <= 0.0) {
    return 0.0;
  }
  const double phase_s = time_s - period_s * std::floor(time_s / period_s) - params.level_rest_s;
  if (phase_s <= 0.0) {
    return 0.0;
  }
  if (phase_s <= down_s) {
    return params.speed_radps * phase_s;
  }
  return phase_s <= 2.0 * down_s + up_s ? params.to_rad - params.speed_radps * (phase_s - down_s)
                                        : params.from_rad + params.speed_radps * (phase_s - 2.0 * down_s - up_s);
}

TiltedSimulation simulate_tilted(const World& world, const TiltMount& mount, const SimulatedLrfParams& lrf_params,
                                 const TiltMotionParams& tilt, std::uint64_t seed) {
  const Path path(world.waypoints);
  SimulatedLrf lrf(lrf_params, seed);
  TiltedSimulation simulation;
  add_angles(tilt, path.duration_s(), simulation.log);
  for (int i = 0; i / lrf_params.rate_hz <= path.duration_s(); ++i) {
    const std::int64_t stamp_ns = stamp_ns_of(i / lrf_params.rate_hz);
    const double start_s = static_cast<double>(stamp_ns) * 1e-9;
    const auto range_m = [&](double time_s, double angle_rad) {
      const Pose3 world_T_laser = Pose3::of(path.at(time_s)) * mount.robot_T_laser(simulated_tilt_rad(tilt, time_s));
      return cast_beam_m(world.building, world_T_laser, angle_rad);
    };
    LogScan scan{.stamp_ns = stamp_ns,
                 .start_angle_rad = to_float_precision(lrf.start_angle_rad()),
                 .angle_step_rad = to_float_precision(lrf.angle_step_rad()),
                 .beam_period_ns = std::llround(lrf.beam_period_s() * 1e9),
                 .ranges_m = {}};
    for (const double measured_m : lrf.sweep(range_m, start_s)) {
      scan.ranges_m.push_back(static_cast<float>(measured_m));
    }
    simulation.log.scans.push_back(std::move(scan));
    simulation.truth.push_back({stamp_ns, path.at(start_s) * mount.robot_T_scan()});
  }
  simulation.log.row_offset_ns = stamp_ns_of(tilt.clock_ahead_s);
  return simulation;
}

}  // namespace odoless
