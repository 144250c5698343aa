#include "tools/cloud/cloud_job.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/support/data.hpp"
#include "tests/support/run_command.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/tools/sim_support.hpp"
#include "tools/command/error.hpp"
#include "tools/sim/world_file.hpp"

namespace odoless {
namespace {

using test::content_of;
using ::testing::HasSubstr;

constexpr double kDeg = test::kRadPerDeg;

double seconds(std::int64_t time_ns) { return static_cast<double>(time_ns) * 1e-9; }

TiltMountParams off_axis_mount() {
  return {.robot_T_tilt = {.x_m = 0.1, .z_m = 0.6}, .tilt_T_laser = {.x_m = 0.05, .z_m = 0.04}};
}

/// One room and a short way at 0.5 m/s, with a laser of a third of the beams: seconds of work.
class CloudOfARoom : public ::testing::Test {
 protected:
  [[nodiscard]] CloudJob job() const {
    CloudJob job;
    job.input = folder_
                    .file("room.world",
                          "ceiling 2.5\nroom 0 0  7 5\nbox_height 0.8\nbox 5.5 4 1 0.6\nbox 3 0.3 1.2 0.4\n"
                          "box 0.3 4 0.4 0.8\ntable 3 4 1.2 0.8\nspeed 0.5\nturn_rate 40\n"
                          "corner_radius 0.4\ngo 1 1.2  5.5 1.2  5.5 2.7\n")
                    .string();
    job.lrf = {.field_of_view_rad = 270.0 * kDeg,
               .beams = 361,
               .rate_hz = 40.0,
               .range_max_m = 30.0,
               .noise_sd_m = 0.01,
               .distortion = true};
    job.params.mapping.mount = off_axis_mount();
    job.clock_ahead_s = 0.0;
    return job;
  }
  [[nodiscard]] static CloudResult run(const CloudJob& job) {
    return run_cloud_job(job, [](std::int64_t, std::int64_t, double) {});
  }

  test::TemporaryFolder folder_;
};

TEST_F(CloudOfARoom, IsTrueAndItsCalibrationIsSeenToBeRight) {
  const CloudResult result = run(job());
  ASSERT_TRUE(result.truth.has_value());
  EXPECT_LE(result.truth->distance_m.median, 0.020);
  EXPECT_LE(result.truth->distance_m.percentile_95, 0.060);
  EXPECT_GT(result.points.size(), 20'000U);
  EXPECT_LE(result.check.floor_deviation_m.percentile_95, 0.020);
  EXPECT_TRUE(result.check.is_straight());
}

/// What is believed of the mount is wrong by one thing.
TEST_F(CloudOfARoom, CheckFiresAtAWrongCalibration) {
  const auto wrong = [](auto change) {
    TiltMountParams mount = off_axis_mount();
    change(mount);
    return mount;
  };
  const std::vector<std::pair<const char*, TiltMountParams>> cases{
      {"laser looks 2 deg lower", wrong([](TiltMountParams& m) { m.tilt_T_laser.pitch_rad += 2.0 * kDeg; })},
      {"laser rolled by 2 deg", wrong([](TiltMountParams& m) { m.tilt_T_laser.roll_rad += 2.0 * kDeg; })},
      {"axis rolled by 2 deg", wrong([](TiltMountParams& m) { m.robot_T_tilt.roll_rad += 2.0 * kDeg; })},
      {"axis 5 cm lower", wrong([](TiltMountParams& m) { m.robot_T_tilt.z_m -= 0.05; })}};
  for (const auto& [what, mount] : cases) {
    CloudJob wrong_job = job();
    wrong_job.true_mount = mount;
    const CloudResult result = run(wrong_job);
    EXPECT_TRUE(result.check.saw_enough()) << what;
    EXPECT_FALSE(result.check.is_straight()) << what;
  }
}

TEST_F(CloudOfARoom, FindsHowFarTheServosClockIsAhead) {
  CloudJob late = job();
  late.tilt.clock_ahead_s = 0.35;
  CloudJob by_rows = late;
  by_rows.clock_ahead_s.reset();
  const TiltMount mount(late.params.mapping.mount);
  EXPECT_NEAR(seconds(run(by_rows).clock.clock_ahead_ns), 0.35, 0.004);
  // From a start that is wrong by 50 ms.
  const World world = read_world(late.input);
  const TiltedSimulation simulation = simulate_tilted(world, mount, late.lrf, late.tilt, 1);
  const CloudSetup setup{{.clock_ahead_ns = 300'000'000}, late.params.mapping, late.params.robot, 1};
  const CloudRun first = make_cloud(simulation.log, setup, [](std::int64_t, std::int64_t, double) {});
  const ClockEstimate clock = align_clocks(simulation.log, setup, first.slam);
  EXPECT_NEAR(seconds(clock.clock_ahead_ns), 0.35, 0.006);
  EXPECT_TRUE(clock.is_told);
  EXPECT_LT(clock.voxels_per_return, clock.voxels_per_return_before);
}

TEST_F(CloudOfARoom, CommandWritesEveryOutput) {
  const CloudJob made = job();
  const auto out = folder_.path() / "out";
  const test::Outcome done =
      test::run({"cloud", made.input, "--out", out.string(), "--beams", "181", "--clock-ahead-ms", "0",
                 "--tilt-angle-rate-hz", "40", "--keys-shown", "2", "--write-log"});
  ASSERT_EQ(done.status, 0) << done.err;
  EXPECT_THAT(done.out, HasSubstr("floor"));
  const auto summary = nlohmann::json::parse(content_of(out / "summary.json"));
  EXPECT_GT(summary["points_written"].get<int>(), 5'000);
  EXPECT_TRUE(content_of(out / "cloud.ply").starts_with("ply\n"));
  EXPECT_TRUE(content_of(out / "cloud.pcd").starts_with("# .PCD v0.7"));
  for (const char* picture : {"cloud_top.png", "cloud_perspective.png", "cloud_keys.png"}) {
    EXPECT_TRUE(content_of(out / picture).starts_with("\x89PNG")) << picture;
  }
  // What was simulated, with an angle per scan, is a log that gives the same cloud but for its ranges in whole
  // millimetres.
  const auto again = folder_.path() / "again";
  const test::Outcome read =
      test::run({"cloud", (out / "tilt_log.csv").string(), "--out", again.string(), "--clock-ahead-ms", "0"});
  ASSERT_EQ(read.status, 0) << read.err;
  const auto second = nlohmann::json::parse(content_of(again / "summary.json"));
  EXPECT_NEAR(second["points_written"].get<double>() / summary["points_written"].get<double>(), 1.0, 0.03);
}

TEST(CloudOfARecordedLog, TakesMostScansAndSaysWhatTheClocksDifferBy) {
  ODOLESS_DATA_FILE(log, "tilt-epfl-lidarServo.csv.xz");
  CloudJob job;
  job.input = log.string();
  job.servo.level_rad = 90.0 * kDeg;
  job.params.mapping.pose_gap_max_s = 30.0;  // it nods slowly
  job.params.mapping.yaw_doubt_max_rad = 5.0 * kDeg;
  const CloudResult result = run_cloud_job(job, [](std::int64_t, std::int64_t, double) {});
  EXPECT_GT(result.run.scans_in_cloud, 200);
  EXPECT_GT(result.points.size(), 20'000U);
  EXPECT_TRUE(result.clock.is_told);
  EXPECT_LT(std::abs(seconds(result.clock.clock_ahead_ns)), 0.4);
}

TEST_F(CloudOfARoom, SaysWhenNothingIsLevel) {
  CloudJob never_level = job();
  never_level.servo.level_rad = 1.0;
  EXPECT_THAT([&] { static_cast<void>(run(never_level)); },
              ::testing::ThrowsMessage<UserError>(HasSubstr("level enough")));
}

}  // namespace
}  // namespace odoless
