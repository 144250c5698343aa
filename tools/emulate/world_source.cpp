#include "tools/emulate/world_source.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "tools/sim/ray_caster.hpp"

namespace odoless {

WorldSource::WorldSource(std::int64_t period_ns, WorldDrive drive)
    : period_ns_(period_ns), drive_(std::move(drive)), path_(drive_.world.waypoints) {}

Pose2 WorldSource::pose_at(std::int64_t time_ns) const {
  return path_.at((static_cast<double>(time_ns) * 1e-9 - drive_.start_delay_s) * drive_.speed_ratio);
}

std::optional<Pose2> WorldSource::world_T_robot(std::int64_t time_ns) const { return pose_at(time_ns); }

std::int64_t WorldSource::duration_ns() const {
  return std::llround((drive_.start_delay_s + path_.duration_s() / drive_.speed_ratio) * 1e9);
}

void WorldSource::measure(std::int64_t index, std::span<const EmulatedBeam> beams, std::span<double> ranges_m) {
  Rng noise(drive_.seed, static_cast<std::uint64_t>(index));
  Pose2 world_T_scan = beams.empty() ? Pose2{} : pose_at(start_ns(index) + beams.front().time_ns);
  for (std::size_t i = 0; i < beams.size(); ++i) {
    if (drive_.distortion) {
      world_T_scan = pose_at(start_ns(index) + beams[i].time_ns);
    }
    const double angle_rad = world_T_scan.yaw_rad + beams[i].angle_rad;
    const double time_s = static_cast<double>(start_ns(index) + (drive_.distortion ? beams[i].time_ns : 0)) * 1e-9;
    const double true_m = cast_ray_m(drive_.world, time_s, {world_T_scan.x_m, world_T_scan.y_m},
                                     {std::cos(angle_rad), std::sin(angle_rad)});
    ranges_m[i] = std::max(0.0, true_m + drive_.noise_sd_m * noise.normal());
  }
}

}  // namespace odoless
