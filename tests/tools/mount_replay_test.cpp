// A laser may be mounted in any way: the map is the same, and the poses are the robot's.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "core/base/rng.hpp"
#include "drivers/lrf/models.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tools/eval/ate.hpp"
#include "tools/log/reference_poses.hpp"
#include "tools/log/scan_log.hpp"
#include "tools/output/trajectory.hpp"
#include "tools/replay/replay.hpp"
#include "tools/sim/path.hpp"
#include "tools/sim/ray_caster.hpp"
#include "tools/sim/simulation.hpp"
#include "tools/sim/world_file.hpp"

namespace odoless {
namespace {

constexpr auto kQuiet = [](std::int64_t, std::int64_t, double) {};
constexpr double kStep_rad = 1.0 / 64.0;  // exact in floating point, as the angles of a real laser nearly are
constexpr int kBeams = 301;
constexpr std::int64_t kPeriod_ns = 200'000'000;

/// Scans of a laser that is mounted so on a robot that is at these poses; each beam of its own list, so that a laser
/// that hangs upside down tells the robot's left first.
ScanLog record(const World& world, const LaserMountParams& params, const std::vector<Pose2>& world_T_robot) {
  const LaserPlace laser = LaserPlace::of(params);
  Rng noise(1);
  ScanLog log{.format = "made up", .has_stamps = true, .scans = {}};
  for (const Pose2& pose : world_T_robot) {
    const Pose2 world_T_scan = laser.scan_of(pose);
    LogScan scan{.stamp_ns = static_cast<std::int64_t>(log.scans.size() + 1) * kPeriod_ns,
                 .start_angle_rad = -0.5 * (kBeams - 1) * kStep_rad,
                 .angle_step_rad = kStep_rad,
                 .ranges_m = std::vector<float>(kBeams)};
    for (int i = 0; i < kBeams;
         ++i) {  // from the robot's right to its left, so that noise is the same however it hangs
      const int beam = laser.is_flipped ? kBeams - 1 - i : i;
      const double angle_rad =
          world_T_scan.yaw_rad + laser.bearing_rad(scan.start_angle_rad + beam * scan.angle_step_rad);
      const double true_m =
          cast_ray_m(world, {world_T_scan.x_m, world_T_scan.y_m}, {std::cos(angle_rad), std::sin(angle_rad)});
      scan.ranges_m[static_cast<std::size_t>(beam)] = static_cast<float>(true_m + 0.01 * noise.normal());
    }
    log.scans.push_back(std::move(scan));
  }
  return log;
}

World room(const std::string& turn_rate_degps = "60") {
  return parse_world("room 0 0  9 6\nbox 2 4  1 0.5\nbox 6 1.5  0.5 1\npillar 7 4.5 0.2\nspeed 0.8\nturn_rate " +
                         turn_rate_degps + "\ngo 1.5 1.5  5 1.5  7.5 3.5  5 4.8  1.5 2.5\n",
                     "room");
}

std::vector<Pose2> drive_through(const World& world) {
  const Path path(world.waypoints);
  std::vector<Pose2> poses;
  for (double time_s = 0.0; time_s < path.duration_s(); time_s += 0.2) {
    poses.push_back(path.at(time_s));
  }
  return poses;
}

ReplayResult map_of(const ScanLog& log, const LaserMountParams& mount) {
  RobotParams params;
  params.mount = mount;
  return replay(log, params, {}, kQuiet);
}

void expect_same(const ReplayResult& one, const ReplayResult& other) {
  EXPECT_EQ(one.map.width_cells, other.map.width_cells);
  EXPECT_EQ(one.map.occupancy_percent, other.map.occupancy_percent);
  EXPECT_EQ(format_trajectory(one.trajectory), format_trajectory(other.trajectory));
  EXPECT_EQ(format_trajectory(one.online_trajectory), format_trajectory(other.online_trajectory));
}

TEST(Mount, GivesTheSameMapToTheCellUpsideDown) {
  const World world = room();
  const std::vector<Pose2> drive = drive_through(world);
  const ReplayResult upright = map_of(record(world, {}, drive), {});
  ASSERT_GT(upright.map.width_cells, 50);
  for (const LaserMountParams& mount : {LaserMountParams{.upside_down = true}, LaserMountParams{.mirrored = true},
                                        LaserMountParams{.upside_down = true, .mirrored = true}}) {
    expect_same(map_of(record(world, mount, drive), mount), upright);
  }
  const ReplayResult unsaid = map_of(record(world, {.upside_down = true}, drive), {});
  EXPECT_NE(unsaid.map.occupancy_percent, upright.map.occupancy_percent) << "else this tests nothing";
}

TEST(Mount, TellsThePoseOfARobotThatTurnsOnTheSpot) {
  const World world = room();
  std::vector<Pose2> drive;
  for (int i = 0; i < 75; ++i) {  // a whole turn and more, at 30 deg/s
    drive.push_back({4.0, 3.0, wrap_angle(0.3 + i * 0.2 * std::numbers::pi / 6.0)});
  }
  for (const LaserMountParams& mount :
       {LaserMountParams{.x_m = 0.4, .y_m = -0.15, .yaw_rad = 0.6},
        LaserMountParams{.x_m = -0.3, .y_m = 0.1, .yaw_rad = -2.5, .upside_down = true}}) {
    const LaserPlace laser = LaserPlace::of(mount);
    const ReplayResult result = map_of(record(world, mount, drive), mount);
    const std::vector<StampedPose> robot = robot_trajectory(result.trajectory, laser);
    ASSERT_EQ(robot.size(), drive.size());
    const Pose2 map_T_world = robot.front().map_T_scan * drive.front().inverse();
    double laser_way_m = 0.0;
    for (std::size_t i = 0; i < drive.size(); ++i) {
      const Pose2 truth = map_T_world * drive[i];
      EXPECT_LT(robot[i].map_T_scan.distance_m(truth), 0.05) << i;
      EXPECT_LT(std::abs(wrap_angle(robot[i].map_T_scan.yaw_rad - truth.yaw_rad)), 0.02) << i;
      laser_way_m = std::max(laser_way_m, result.trajectory[i].map_T_scan.distance_m(result.trajectory[0].map_T_scan));
    }
    EXPECT_GT(laser_way_m, 0.5) << "the laser itself goes round";
  }
}

// CARMEN's logs do not tell when a beam was measured. At 10 Hz, a turn of 90 deg/s shears scans by 9 deg.
TEST(Mount, TakesOutTheMotionOfASweepThatTheScansDoNotTell) {
  SimulatedLrfParams lrf = simulated_lrf_params(*find_lrf_model("rplidar-s2"));
  lrf.distortion = true;
  const Simulation simulation = simulate(room("90"), lrf, 1);
  const test::TemporaryFolder folder;
  const std::vector<ReferencePose> truth = read_reference_poses(folder.file("truth.tum", simulation.truth)).poses;
  const ScanLog log = read_scan_log(folder.file("sheared.log", simulation.log));
  ASSERT_EQ(log.scans.front().beam_period_ns, 0);
  const auto off_m = [&](std::int64_t sweep_ns) {
    const ReplayResult result = map_of(log, {.sweep_ns = sweep_ns});
    std::vector<ReferencePose> path;
    for (const StampedPose& pose : result.trajectory) {
      path.push_back({static_cast<double>(pose.stamp_ns) * 1e-9, pose.map_T_scan});
    }
    return evaluate_ate(truth, path, {}).errors.translation_m.root_mean_square;
  };
  const double deskewed_m = off_m(100'000'000);
  EXPECT_LT(deskewed_m, 0.01);
  EXPECT_GT(off_m(0), 2.0 * deskewed_m);
}

TEST(Mount, IgnoredSectorsAreInNoScanAndNoMap) {
  constexpr double kFrom_rad = 0.6;
  constexpr double kTo_rad = 0.8;
  const World world = room();
  const std::vector<Pose2> drive = drive_through(world);
  ScanLog with_mast = record(world, {}, drive);
  ScanLog without = with_mast;
  for (std::size_t i = 0; i < with_mast.scans.size(); ++i) {
    for (int beam = 0; beam < kBeams; ++beam) {
      const double bearing_rad = (beam - 0.5 * (kBeams - 1)) * kStep_rad;
      if (bearing_rad >= kFrom_rad && bearing_rad <= kTo_rad) {
        with_mast.scans[i].ranges_m[static_cast<std::size_t>(beam)] = 0.5F;
        without.scans[i].ranges_m[static_cast<std::size_t>(beam)] = std::numeric_limits<float>::quiet_NaN();
      }
    }
  }
  const LaserMountParams mount{.ignore = {{kFrom_rad, kTo_rad}}};
  expect_same(map_of(with_mast, mount), map_of(without, {}));
  RobotParams params;
  params.mount = mount;
  StageChain chain(params, 1, false);
  static_cast<void>(chain.process(with_mast.scans[0].raw(), with_mast.scans[0].stamp_ns));
  for (int beam = 0; beam < chain.frame().size(); ++beam) {
    const double bearing_rad = chain.frame().angle_rad(beam);
    EXPECT_TRUE(bearing_rad < kFrom_rad || bearing_rad > kTo_rad || chain.frame().state(beam) == BeamState::kInvalid);
  }
}

TEST(Mount, MatchesPairsAsItIsMounted) {
  const World world = room();
  const std::vector<Pose2> drive = drive_through(world);
  const auto rows_of = [&](const LaserMountParams& mount) {
    RobotParams params;
    params.mount = mount;
    return match_pairs(record(world, mount, drive), params, {.every = 8}, kQuiet);
  };
  const std::vector<MatchRow> upright = rows_of({});
  const std::vector<MatchRow> hanging = rows_of({.upside_down = true});
  ASSERT_EQ(upright.size(), hanging.size());
  for (std::size_t i = 0; i < upright.size(); ++i) {
    EXPECT_EQ(upright[i].reference_T_scan.yaw_rad, hanging[i].reference_T_scan.yaw_rad);
    EXPECT_EQ(upright[i].reference_T_scan.y_m, hanging[i].reference_T_scan.y_m);
  }
}

}  // namespace
}  // namespace odoless
