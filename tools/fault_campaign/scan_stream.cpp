#include "tools/fault_campaign/scan_stream.hpp"

#include <cmath>

#include "core/math/elementary.hpp"
#include "tools/sim/ray_caster.hpp"

namespace odoless::campaign {

ScanStream clean_stream(const Scenario& scenario, const Drive& drive) {
  SimulatedLrf lrf(laser_of(scenario), scenario.seed);
  ScanStream stream{.start_angle_rad = lrf.start_angle_rad(), .angle_step_rad = lrf.angle_step_rad()};
  const double period_s = 1.0 / lrf.params().rate_hz;
  const auto count = static_cast<int>(std::floor(drive.duration_s() / period_s)) + 1;
  for (int i = 0; i < count; ++i) {
    const double true_s = i * period_s;
    const Pose2 world_T_scan = drive.at(true_s);
    const auto true_range_m = [&](double /*time_s*/, double angle_rad) {
      const double yaw_rad = world_T_scan.yaw_rad + angle_rad;
      return cast_ray_m(drive.world(), drive.world_s(true_s), {world_T_scan.x_m, world_T_scan.y_m},
                        {math::cos(yaw_rad), math::sin(yaw_rad)});
    };
    const std::span<const double> ranges_m = lrf.sweep(true_range_m, true_s);
    stream.scans.push_back({.true_s = true_s,
                            .stamp_ns = host_ns(true_s),
                            .arrival_ns = host_ns(true_s),
                            .ranges_m = {ranges_m.begin(), ranges_m.end()}});
  }
  return stream;
}

}  // namespace odoless::campaign
