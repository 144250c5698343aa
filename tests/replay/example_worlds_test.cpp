// What the state promises, on drives whose truth is known: OK is right within 0.5 m and 5 deg.
#include <gtest/gtest.h>

#include <algorithm>
#include <ostream>
#include <string>
#include <vector>

#include "drivers/lrf/models.hpp"
#include "firmware/health/health_monitor.hpp"
#include "tests/tools/sim_support.hpp"
#include "tools/log/reference_poses.hpp"
#include "tools/log/scan_log.hpp"
#include "tools/replay/replay.hpp"
#include "tools/sim/simulation.hpp"
#include "tools/sim/world_file.hpp"

namespace odoless {
namespace {

struct DriveCase {
  const char* world;
  const char* laser;
  std::uint64_t seed;

  friend void PrintTo(const DriveCase& drive, std::ostream* out) {
    *out << drive.world << " with " << drive.laser << ", seed " << drive.seed;
  }
};

class ReplayOfAWorld : public ::testing::TestWithParam<DriveCase> {};

TEST_P(ReplayOfAWorld, IsNeverSilentlyWrongForMoreThanASecond) {
  const auto& [name, laser, seed] = GetParam();
  const World world = read_world(test::example_world(std::string(name) + ".world"));
  const SimulatedLrfParams params = simulated_lrf_params(*find_lrf_model(laser));
  const Simulation drive = simulate(world, params, seed);
  LineReader truth_lines(view_bytes(drive.truth, "truth"), "truth");
  const std::vector<ReferencePose> truth = read_reference_poses(truth_lines).poses;
  LineReader lines(view_bytes(drive.log, "simulation"), "simulation");
  const ScanLog log = read_scan_log(lines);
  std::size_t scan = 0;
  int wrong = 0;
  int longest = 0;
  const auto watch = [&](const ChainStep& step, const RawScan& /*raw*/, StageChain& /*chain*/) {
    const Pose2 start_T_true = truth.front().pose.inverse() * truth.at(scan++).pose;
    const bool is_right = are_within(start_T_true, step.filter.map_T_scan, PoseEstimate::kOk_m, PoseEstimate::kOk_rad);
    const bool is_ok =
        step.filter.tracking == Tracking::kSure &&
        step.motion.weak_information_1_m2 >= HealthParams{}.weak_information_1_m2;  // as HealthMonitor has it
    wrong = is_ok && !is_right ? wrong + 1 : 0;
    longest = std::max(longest, wrong);
  };
  static_cast<void>(replay(
      log, RobotParams{}, {.seed = seed}, [](auto...) {}, watch));
  EXPECT_EQ(scan, truth.size());
  EXPECT_LE(longest, params.rate_hz) << "scans in a row";
}

INSTANTIATE_TEST_SUITE_P(ExampleWorlds, ReplayOfAWorld,
                         ::testing::Values(DriveCase{"rooms", "lms200", 1}, DriveCase{"rooms", "lms200", 2},
                                           DriveCase{"rooms", "urg-04lx", 1}, DriveCase{"corridor", "lms200", 1},
                                           DriveCase{"corridor", "rplidar-a1", 1}, DriveCase{"corridor", "utm-30lx", 1},
                                           DriveCase{"hall", "rplidar-a1", 1}, DriveCase{"people", "lms200", 1},
                                           DriveCase{"symmetric", "urg-04lx", 1}));

}  // namespace
}  // namespace odoless
