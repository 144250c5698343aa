#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "tests/keys/key_class.hpp"
#include "tools/cloud/cloud_run.hpp"
#include "tools/command/error.hpp"
#include "tools/sim/tilted_simulation.hpp"
#include "tools/sim/world_file.hpp"

namespace odoless::test {
namespace {

constexpr const char* kSmall = R"(
[scan]
beams_max = 128
[matcher]
points_max = 512
[matcher.search]
start_points = 60
coarse_evaluations = 120
fine_evaluations = 120
[odometry]
key_scans = 4
[slam.low]
particles = 8
[slam.low.grid]
width_m = 24.0
height_m = 24.0
tiles_max = 400
[mapping]
level.tilt_max_deg = 10.0
level.returns_min = 40
cloud.points_max = 20000
cloud.keys_max = 20
cloud.key_voxels_max = 20000
mount.tilt_T_laser.x_m = 0.05
)";

/// A nodding laser in a room.
TiltLog nodding_drive(const TiltMountParams& mount) {
  const World world = parse_world(
      "room 0 0  8 5\nbox 5 4  1 0.6  20\nspeed 0.8\nturn_rate 60\n"
      "go 1.5 1.5  4.5 1.5  5 3\n",
      "keys");
  SimulatedLrfParams lrf;
  lrf.beams = 91;
  lrf.rate_hz = 15.0;
  lrf.distortion = true;
  TiltMotionParams tilt;
  tilt.from_rad = -0.4;
  tilt.to_rad = 0.5;
  tilt.speed_radps = 2.0;
  return simulate_tilted(world, TiltMount(mount), lrf, tilt, 1).log;
}

/// The same with a servo that says nothing for a while.
TiltLog drive_with_gap() {
  TiltLog log = nodding_drive({});
  std::erase_if(log.angles, [](const ServoAngle& angle) {
    return angle.stamp_ns > 2'000'000'000 && angle.stamp_ns < 2'400'000'000;
  });
  return log;
}

std::string mapped(const TiltLog& log, const DaemonParams& params) {
  try {
    const CloudRun run = make_cloud(log, {.mapping = params.mapping, .robot = params.robot}, [](auto, auto, auto) {});
    const KeyedCloud& cloud = run.mapper.cloud();
    std::string text = fmt::format("{} level, {} mapped, {} without pose, {} keys, {} refused\n", run.level_scans,
                                   run.scans_in_cloud, run.scans_without_pose, cloud.keys().size(), cloud.refused());
    for_each_point(cloud, [&text](std::size_t key, const Point3& p_map, std::uint32_t count) {
      text += fmt::format("{} {:.4f} {:.4f} {:.4f} {}\n", key, p_map.x_m, p_map.y_m, p_map.z_m, count);
    });
    return text;
  } catch (const UserError& refusal) {
    return refusal.what();
  }
}

/// As `odoless cloud` maps a world, in which the laser is where the configuration says.
std::string simulated(const DaemonParams& params) { return mapped(nodding_drive(params.mapping.mount), params); }

std::vector<Scene> all_mapping_scenes() {
  const auto look = [log = drive_with_gap()](const DaemonParams& params) { return mapped(log, params); };
  return {{"cloud", {kSmall}, look},
          {"full keys", {kSmall, "mapping.cloud.keys_max = 2\nmapping.cloud.key_distance_m = 0.5\n"}, look},
          {"simulated", {kSmall}, simulated}};
}

}  // namespace

KeyClass mapping_class() { return {"mapping", {"mapping."}, all_mapping_scenes}; }

}  // namespace odoless::test
