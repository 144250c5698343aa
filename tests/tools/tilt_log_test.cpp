#include "tools/log/tilt_log.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/data.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tools/command/error.hpp"
#include "tools/sim/path.hpp"
#include "tools/sim/tilted_simulation.hpp"
#include "tools/sim/world_file.hpp"

namespace odoless {
namespace {

using ::testing::HasSubstr;

TiltLog parse(const std::string& text) {
  LineReader lines(view_bytes(text, "log"), "log");
  return read_tilt_log(lines);
}

std::string failure(const std::string& text) {
  try {
    static_cast<void>(parse(text));
  } catch (const DataError& error) {
    return error.what();
  }
  return "nothing was wrong";
}

const std::string kFirst = "1.0,100.10,90,5.00,-1,1,0.5,0.001,0.05,10,5,1,2,0,4,5\n";
const std::string kSecond = "1.1,100.21,95,5.10,-1,1,0.5,0.001,0.05,10,5,1,2,0,4,5\n";

TEST(TiltLog, ReadsScansAndAnglesEachByItsClock) {
  const TiltLog log = parse(kFirst + kSecond);
  ASSERT_EQ(log.scans.size(), 2U);
  ASSERT_EQ(log.angles.size(), 2U);
  EXPECT_EQ(log.scans[1].stamp_ns, 5'100'000'000);
  EXPECT_EQ(log.scans[1].beam_period_ns, 1'000'000);
  EXPECT_EQ(log.angles[1].stamp_ns, 100'210'000'000);
  EXPECT_NEAR(log.angles[1].angle_rad, 95.0 * std::numbers::pi / 180.0, 1e-12);
  EXPECT_THAT(log.scans[0].ranges_m, ::testing::ElementsAre(1.0F, 2.0F, 0.0F, 4.0F, 5.0F));
  EXPECT_EQ(log.row_offset_ns, 95'110'000'000);
}

TEST(TiltLog, SortsAnglesAndPassesOverRowsWithoutANewScan) {
  const TiltLog log = parse(kSecond + kFirst + "1.2,100.15,91,9,0,6,inf,0,0.05,10,0\n" +
                            "1.3,100.40,99,6.0,-1,1,0.5,0,0.05,10,3,1,2,3\n");
  EXPECT_EQ(log.scans.size(), 2U) << "the second row's scan is older, the third has none";
  EXPECT_EQ(log.doubled_scans, 1);
  EXPECT_EQ(log.empty_rows, 1);
  ASSERT_EQ(log.angles.size(), 4U);
  for (std::size_t i = 1; i < log.angles.size(); ++i) {
    EXPECT_LT(log.angles[i - 1].stamp_ns, log.angles[i].stamp_ns);
  }
}

TEST(TiltLog, SaysWhatIsWrongWhere) {
  EXPECT_THAT(failure(kFirst), HasSubstr("1 scans and 1 angles"));
  EXPECT_THAT(failure(kFirst + "1.1,100,90\n"), HasSubstr("log:2"));
  EXPECT_THAT(failure(kFirst + "1.1,100.2,x,5.1,-1,1,0.5,0,0.05,10,1,1\n"), HasSubstr("log:2"));
  EXPECT_THAT(failure(kFirst + "1.1,100.2,90,5.1,-1,1,0.5,0,0.05,10,9,1\n"), HasSubstr("do not fit 9 ranges"));
  EXPECT_THAT(failure(kFirst + "1.1,100.2,90,5.1,-1,1,0,0,0.05,10,1,1\n"), HasSubstr("angle_inc"));
  EXPECT_THAT(failure(kFirst + "1.1,100.2,90,5.1,-1,1,0.1,7,0.05,10,1,1\n"), HasSubstr("time_inc"));
  EXPECT_THAT(failure(kFirst + "1.1,100.2,inf,5.1,-1,1,0.5,0,0.05,10,1,1\n"), HasSubstr("log:2"));
  EXPECT_THAT(failure(kFirst + "1.1,-3.1e9,90,5.1,-1,1,0.5,0,0.05,10,1,1\n"), HasSubstr("3e9 s"));
  EXPECT_THAT(failure(kFirst + "1.1,100.2,90,9e9,-1,1,0.5,0,0.05,10,1,1\n"), HasSubstr("3e9 s"));
}

TEST(TiltLog, IsToldFromOtherLogs) {
  const test::TemporaryFolder folder;
  EXPECT_TRUE(is_tilt_log(folder.file("tilt.csv", "# a comment\n" + kFirst)));
  EXPECT_FALSE(is_tilt_log(folder.file("handheld.csv", "0.1,-2,0.01,0,0.1,0.02,5.6,5,1.1,2,1.5,1,2\n")));
  EXPECT_FALSE(is_tilt_log(folder.file("carmen.log", "FLASER 2 1 2 0 0 0 0 0 0 1 host 1\n")));
  EXPECT_FALSE(is_tilt_log(folder.file("empty.log", "")));
}

TEST(TiltLog, ReadsTheRecordedOnes) {
  ODOLESS_DATA_FILE(slow, "tilt-epfl-lidarServo.csv.xz");
  ODOLESS_DATA_FILE(fast, "tilt-epfl-servo-imu-3hz.csv.xz");
  const TiltLog first = read_tilt_log(slow);
  EXPECT_EQ(first.scans.size() + static_cast<std::size_t>(first.empty_rows + first.doubled_scans), 298U);
  EXPECT_EQ(first.angles.size(), 298U);
  EXPECT_NEAR(static_cast<double>(first.row_offset_ns) * 1e-9, 0.057, 0.002);
  const TiltLog second = read_tilt_log(fast);
  EXPECT_EQ(second.scans.size() + static_cast<std::size_t>(second.empty_rows + second.doubled_scans), 204U);
  EXPECT_EQ(second.doubled_scans, 2);
}

TEST(TiltLog, ReadsWhatItWrote) {
  const World world = parse_world("room 0 0 6 5\nbox 4 3 1 1\ngo 1 1  2 1\n", "world");
  const SimulatedLrfParams lrf{.beams = 91, .rate_hz = 20.0, .distortion = true};
  const TiltMotionParams tilt{.angle_rate_hz = 200.0, .clock_ahead_s = 0.3};
  const TiltedSimulation made = simulate_tilted(world, TiltMount(TiltMountParams{}), lrf, tilt, 1);
  const TiltLog read = parse(tilt_csv(made.log, made.log.row_offset_ns));
  ASSERT_EQ(read.scans.size(), made.log.scans.size());
  EXPECT_EQ(read.row_offset_ns, 300'000'000);
  for (std::size_t i = 0; i < read.scans.size(); ++i) {
    EXPECT_EQ(read.scans[i].stamp_ns, made.log.scans[i].stamp_ns);
    EXPECT_EQ(read.scans[i].beam_period_ns, made.log.scans[i].beam_period_ns);
    EXPECT_NEAR(read.angles[i].angle_rad, simulated_tilt_rad(tilt, static_cast<double>(read.scans[i].stamp_ns) * 1e-9),
                1e-7);
    EXPECT_NEAR(read.scans[i].ranges_m[45], made.log.scans[i].ranges_m[45], 0.00051);
  }
}

TEST(SlowedWorld, IsDrivenNoFasterThanThat) {
  const World world = parse_world("room 0 0 6 5\nspeed 1.0\ngo 1 1  3 1\nspeed 0.25\ngo 5 1\n", "world");
  const auto drive_s = [](const World& driven) { return Path(driven.waypoints).duration_s(); };
  EXPECT_NEAR(drive_s(world), 2.0 + 8.0, 1e-9);
  EXPECT_NEAR(drive_s(slowed(world, 0.5)), 4.0 + 8.0, 1e-9);
  EXPECT_NEAR(drive_s(slowed(world, 2.0)), 2.0 + 8.0, 1e-9);
}

TEST(SimulatedTilt, NodsOrRestsWithinItsEndsAtItsSpeed) {
  for (const double rest_s : {0.0, 1.5}) {
    const TiltMotionParams tilt{.from_rad = -0.3, .to_rad = 0.7, .speed_radps = 2.0, .level_rest_s = rest_s};
    double lowest_rad = 0.0;
    double highest_rad = 0.0;
    int level = 0;
    constexpr double kStepS = 0.001;
    for (int i = 1; i < 20'000; ++i) {
      const double angle_rad = simulated_tilt_rad(tilt, i * kStepS);
      lowest_rad = std::min(lowest_rad, angle_rad);
      highest_rad = std::max(highest_rad, angle_rad);
      level += angle_rad == 0.0 ? 1 : 0;
      EXPECT_LE(std::abs(angle_rad - simulated_tilt_rad(tilt, (i - 1) * kStepS)), 2.0 * kStepS + 1e-12);
    }
    EXPECT_NEAR(lowest_rad, -0.3, 0.002);
    EXPECT_NEAR(highest_rad, 0.7, 0.002);
    EXPECT_NEAR(level * kStepS, rest_s > 0.0 ? 20.0 * 1.5 / 2.5 : 0.0, 0.1);
  }
}

}  // namespace
}  // namespace odoless
