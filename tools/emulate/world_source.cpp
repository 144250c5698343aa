#include "tools/emulate/world_source.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/math/elementary.hpp"
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

double WorldSource::true_range_m(std::int64_t time_ns, const Pose2& world_T_robot, double angle_rad) const {
  if (tilt_) {
    return cast_beam_m(drive_.world.building,
                       Pose3::of(world_T_robot) * tilt_->mount.robot_T_laser(tilt_->tilt_rad(time_ns)), angle_rad);
  }
  const double world_angle_rad = world_T_robot.yaw_rad + angle_rad;
  return cast_ray_m(drive_.world, static_cast<double>(time_ns) * 1e-9, {world_T_robot.x_m, world_T_robot.y_m},
                    {math::cos(world_angle_rad), math::sin(world_angle_rad)});
}

void WorldSource::measure(std::int64_t index, std::span<const EmulatedBeam> beams, std::span<double> ranges_m) {
  Rng noise(drive_.seed, static_cast<std::uint64_t>(index));
  Pose2 world_T_robot;
  for (std::size_t i = 0; i < beams.size(); ++i) {
    const std::int64_t time_ns = start_ns(index) + beams[drive_.distortion ? i : 0].time_ns;
    if (drive_.distortion || i == 0) {
      world_T_robot = pose_at(time_ns);
    }
    const double true_m = true_range_m(time_ns, world_T_robot, beams[i].angle_rad);
    ranges_m[i] = std::max(0.0, true_m + drive_.noise_sd_m * noise.normal());
  }
}

}  // namespace odoless
