#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <ostream>
#include <sstream>

#include "tests/tools/sim_support.hpp"
#include "tools/log/scan_log.hpp"
#include "tools/sim/ray_caster.hpp"
#include "tools/sim/simulation.hpp"
#include "tools/sim/world_file.hpp"

namespace odoless {
namespace {

World small_world() {
  return parse_world("room 0 0 12 5\npillar 6 4 0.3\nbox 9 1 1 1 30\nspeed 1\ngo 1 2  8 2.5  10 4", "small.world");
}

ScanLog read_back(const Simulation& simulation) {
  LineReader lines(view_bytes(simulation.log, "simulation"), "simulation");
  return read_scan_log(lines);
}

std::vector<Pose2> poses_of(const std::string& tum, std::vector<double>& stamps_s) {
  std::vector<Pose2> poses;
  std::istringstream in(tum);
  double stamp_s, x, y, z, qx, qy, qz, qw;  // NOLINT: one line of TUM
  while (in >> stamp_s >> x >> y >> z >> qx >> qy >> qz >> qw) {
    stamps_s.push_back(stamp_s);
    poses.push_back({x, y, 2.0 * std::atan2(qz, qw)});
  }
  return poses;
}

/// Each range of the log against the ray from the true pose at the angle that the reader gives the beam.
void expect_log_shows_world(const World& world, const SimulatedLrfParams& params, const char* format) {
  const Simulation simulation = simulate(world, params, 1);
  const ScanLog log = read_back(simulation);
  EXPECT_EQ(log.format, format);
  EXPECT_TRUE(log.has_stamps);
  std::vector<double> stamps_s;
  const std::vector<Pose2> poses = poses_of(simulation.truth, stamps_s);
  ASSERT_EQ(log.scans.size(), poses.size());
  ASSERT_EQ(poses.size(), static_cast<std::size_t>(simulation.scans));
  for (std::size_t k = 0; k < poses.size(); ++k) {
    const LogScan& scan = log.scans[k];
    ASSERT_EQ(scan.ranges_m.size(), static_cast<std::size_t>(params.beams));
    ASSERT_NEAR(static_cast<double>(scan.stamp_ns) * 1e-9, stamps_s[k], 1e-9);
    for (std::size_t i = 0; i < scan.ranges_m.size(); ++i) {
      const double angle_rad = poses[k].yaw_rad + scan.start_angle_rad + static_cast<double>(i) * scan.angle_step_rad;
      const Point2 direction{std::cos(angle_rad), std::sin(angle_rad)};
      const double true_m = cast_ray_m(world, {poses[k].x_m, poses[k].y_m}, direction);
      if (true_m > params.range_max_m) {
        ASSERT_GE(scan.ranges_m[i], scan.no_return_m) << "scan " << k << ", beam " << i;
      } else {
        ASSERT_NEAR(scan.ranges_m[i], true_m, 0.001) << "scan " << k << ", beam " << i;
      }
    }
  }
}

TEST(Simulation, FlaserLogShowsTheWorldFromTheTruePoses) {
  expect_log_shows_world(small_world(), {.noise_sd_m = 0.0}, "CARMEN FLASER");
  expect_log_shows_world(small_world(), {.beams = 361, .range_max_m = 5.0, .noise_sd_m = 0.0}, "CARMEN FLASER");
}

TEST(Simulation, OtherLasersMakeARobotLaserLog) {
  for (const LrfModel& model : lrf_models()) {
    SimulatedLrfParams params = simulated_lrf_params(model);
    params.noise_sd_m = 0.0;
    if (params.beams != 181 && params.beams != 361) {
      expect_log_shows_world(small_world(), params, "CARMEN ROBOTLASER1");
    }
  }
  expect_log_shows_world(small_world(), {.range_max_m = 100.0, .noise_sd_m = 0.0}, "CARMEN ROBOTLASER1");
}

TEST(Simulation, ScansOncePerPeriodFromStartToEnd) {
  const World world = parse_world("speed 1\ngo 0 0  2.95 0", "line.world");
  const Simulation simulation = simulate(world, {.rate_hz = 10.0}, 1);
  EXPECT_EQ(simulation.scans, 30);
  EXPECT_NEAR(simulation.duration_s, 2.95, 1e-9);
  EXPECT_NEAR(simulation.length_m, 2.95, 1e-9);
  const ScanLog log = read_back(simulation);
  EXPECT_EQ(log.scans.front().stamp_ns, 0);
  EXPECT_EQ(log.scans.back().stamp_ns, 2'900'000'000);
}

TEST(Simulation, SameSeedSameBytesAndAnotherSeedOtherRanges) {
  const SimulatedLrfParams params{.no_return_share = 0.1};
  const Simulation first = simulate(small_world(), params, 11);
  const Simulation again = simulate(small_world(), params, 11);
  const Simulation other = simulate(small_world(), params, 12);
  EXPECT_EQ(first.log, again.log);
  EXPECT_EQ(first.truth, again.truth);
  EXPECT_NE(first.log, other.log);
  EXPECT_EQ(first.truth, other.truth);
}

struct Example {
  const char* name;
  double length_min_m;
  double length_max_m;
  double clearance_m;

  friend void PrintTo(const Example& example, std::ostream* out) { *out << example.name; }
};

class ExampleWorld : public ::testing::TestWithParam<Example> {};

TEST_P(ExampleWorld, HasThePathThatItPromisesClearOfEverySurface) {
  const World world = read_world(test::example_world(GetParam().name));
  const Path path(world.waypoints);
  EXPECT_GE(path.length_m(), GetParam().length_min_m);
  EXPECT_LE(path.length_m(), GetParam().length_max_m);
  double nearest_m = std::numeric_limits<double>::infinity();
  for (double time_s = 0.0; time_s < path.duration_s(); time_s += 0.1) {
    const Pose2 pose = path.at(time_s);
    for (int i = 0; i < 72; ++i) {
      const double angle_rad = i * 5.0 * test::kRadPerDeg;
      nearest_m =
          std::min(nearest_m, cast_ray_m(world, {pose.x_m, pose.y_m}, {std::cos(angle_rad), std::sin(angle_rad)}));
    }
  }
  EXPECT_GE(nearest_m, GetParam().clearance_m);
}

INSTANTIATE_TEST_SUITE_P(
    Worlds, ExampleWorld,
    ::testing::Values(Example{"office.world", 140.0, 180.0, 0.3}, Example{"corridor.world", 25.0, 30.0, 0.9},
                      Example{"hall.world", 80.0, 120.0, 3.0}, Example{"symmetric.world", 25.0, 40.0, 0.3},
                      Example{"people.world", 40.0, 70.0, 0.3}, Example{"cave.world", 70.0, 120.0, 0.5},
                      Example{"rooms.world", 60.0, 90.0, 0.3}));

TEST(ExampleWorlds, RoomsHasTheScansOfTheSeedsExperiment) {
  const World world = read_world(test::example_world("rooms.world"));
  EXPECT_NEAR(simulate(world, {}, 1).scans, 366, 2);
}

// Seen from a point and from its image through the middle, the room is the same but for the noise.
TEST(ExampleWorlds, SymmetricLooksTheSameFromTheOppositeCorner) {
  const World world = read_world(test::example_world("symmetric.world"));
  const Pose2 world_T_image{12.0, 8.0, std::numbers::pi};
  for (int i = 0; i < 360; ++i) {
    const double angle_rad = i * test::kRadPerDeg;
    const double range_m = cast_ray_m(world, {1.5, 3.0}, {std::cos(angle_rad), std::sin(angle_rad)});
    const double image_m =
        cast_ray_m(world, world_T_image * Point2{1.5, 3.0}, {-std::cos(angle_rad), -std::sin(angle_rad)});
    EXPECT_NEAR(range_m, image_m, 1e-6) << i;
  }
}

TEST(ExampleWorlds, PeopleWalkAndNeverIntoTheRobot) {
  const World world = read_world(test::example_world("people.world"));
  ASSERT_EQ(world.walkers.size(), 7U);
  const Path path(world.waypoints);
  for (double time_s = 0.0; time_s < path.duration_s(); time_s += 0.05) {
    const Pose2 robot = path.at(time_s);
    for (const Walker& walker : world.walkers) {
      const Pillar body = at_time(walker, time_s);
      EXPECT_GT(std::hypot(body.centre.x_m - robot.x_m, body.centre.y_m - robot.y_m), body.radius_m + 0.1) << time_s;
    }
  }
}

TEST(ExampleWorlds, HallIsWiderThanALaserOf30MetresReaches) {
  const World world = read_world(test::example_world("hall.world"));
  const Path path(world.waypoints);
  SimulatedLrf lrf(simulated_lrf_params(*find_lrf_model("utm-30lx")), 1);
  int blind = 0;
  for (double time_s = 0.0; time_s < path.duration_s(); time_s += 1.0) {
    int returns = 0;
    for (const double range_m : lrf.sweep(world, path, time_s)) {
      returns += std::isfinite(range_m) ? 1 : 0;
    }
    blind += returns == 0 ? 1 : 0;
  }
  EXPECT_GE(blind, 3);
  EXPECT_LT(blind, path.duration_s() / 2.0);
}

}  // namespace
}  // namespace odoless
