#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "tests/support/temporary_folder.hpp"
#include "tests/tools/sim_support.hpp"
#include "tools/command/command_line.hpp"
#include "tools/log/scan_log.hpp"

namespace odoless {
namespace {

using ::testing::HasSubstr;

constexpr const char* kWorld = "room 0 0  8 4\nspeed 1\ngo 1 2  6 2\n";

/// Runs `odoless sim` and returns its status; what it says goes to `said`.
int sim(std::vector<std::string> arguments, std::string& said) {
  arguments.insert(arguments.begin(), {"odoless", "sim"});
  std::vector<const char*> argv;
  for (const std::string& argument : arguments) {
    argv.push_back(argument.c_str());
  }
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  const int status = run_command_line(static_cast<int>(argv.size()), argv.data());
  said = testing::internal::GetCapturedStdout() + testing::internal::GetCapturedStderr();
  return status;
}

class SimCommand : public ::testing::Test {
 protected:
  int run(std::vector<std::string> options, const std::string& world = kWorld) {
    options.insert(options.begin(), {folder_.file("a.world", world).string(), "--out", log_.string()});
    return sim(options, said_);
  }

  test::TemporaryFolder folder_;
  std::filesystem::path log_ = folder_.path() / "a.log";
  std::filesystem::path truth_ = folder_.path() / "a.truth.tum";
  std::string said_;
};

TEST_F(SimCommand, WritesALogThatReadsBackAndTheTruthBesideIt) {
  ASSERT_EQ(run({}), 0) << said_;
  const ScanLog log = read_scan_log(log_);
  EXPECT_EQ(log.scans.size(), 26U);
  EXPECT_EQ(log.scans[0].ranges_m.size(), 181U);
  EXPECT_THAT(test::content_of(truth_), ::testing::StartsWith("0.000000 1.000000000 2.000000000 0 0 0 "));
  EXPECT_THAT(said_, HasSubstr("26 scans of 181 beams"));
}

TEST_F(SimCommand, TheSameSeedGivesTheSameBytes) {
  ASSERT_EQ(run({"--seed", "5"}), 0);
  const std::string first = test::content_of(log_);
  ASSERT_EQ(run({"--seed", "5"}), 0);
  EXPECT_EQ(test::content_of(log_), first);
  ASSERT_EQ(run({"--seed", "6"}), 0);
  EXPECT_NE(test::content_of(log_), first);
}

TEST_F(SimCommand, OptionsOverrideThePresetWhereverTheyStand) {
  ASSERT_EQ(run({"--beams", "91", "--lrf", "utm-30lx", "--rate-hz", "10"}), 0) << said_;
  const ScanLog log = read_scan_log(log_);
  EXPECT_EQ(log.scans.size(), 51U);
  EXPECT_EQ(log.scans[0].ranges_m.size(), 91U);
  EXPECT_NEAR(log.scans[0].start_angle_rad, -135.0 * test::kRadPerDeg, 1e-8);
  EXPECT_NEAR(log.scans[0].angle_step_rad, 3.0 * test::kRadPerDeg, 1e-8);
  EXPECT_FLOAT_EQ(log.scans[0].no_return_m, 30.0F);
}

TEST_F(SimCommand, EveryOptionReachesTheLaser) {
  const std::string truth = (folder_.path() / "b.tum").string();
  ASSERT_EQ(run({"--field-of-view-deg", "360", "--beams", "360", "--rate-hz", "2", "--range-max-m", "2.5",
                 "--noise-sd-m", "0", "--no-return-share", "0.5", "--distortion", "--truth", truth}),
            0)
      << said_;
  const ScanLog log = read_scan_log(log_);
  EXPECT_EQ(log.scans.size(), 11U);
  EXPECT_NEAR(log.scans[0].start_angle_rad, -std::numbers::pi, 1e-7);
  EXPECT_FLOAT_EQ(log.scans[0].no_return_m, 2.5F);
  // To the left, the wall is 2 m away all along the path; half of the beams are swallowed, noise is off.
  int lost = 0;
  for (std::size_t beam = 240; beam <= 300; ++beam) {
    const double off_rad = (static_cast<double>(beam) - 270.0) * test::kRadPerDeg;
    const float range_m = log.scans[5].ranges_m[beam];
    lost += range_m >= log.scans[5].no_return_m ? 1 : 0;
    EXPECT_TRUE(range_m >= 2.5F || std::abs(range_m - 2.0 / std::cos(off_rad)) < 1e-3) << "beam " << beam;
  }
  EXPECT_GT(lost, 15);
  EXPECT_LT(lost, 46);
  EXPECT_TRUE(std::filesystem::exists(truth));
  EXPECT_FALSE(std::filesystem::exists(truth_));
}

TEST_F(SimCommand, AWrongWorldIsExit65AndWritesNothing) {
  EXPECT_EQ(run({}, "room 0 0 4 4\ngo 1 1  9 9"), 65);
  EXPECT_THAT(said_, HasSubstr("a.world:2: "));
  EXPECT_FALSE(std::filesystem::exists(log_));
  EXPECT_FALSE(std::filesystem::exists(truth_));
}

TEST_F(SimCommand, WrongUseIsExit64) {
  for (const std::vector<std::string>& options : std::vector<std::vector<std::string>>{{"--lrf", "none"},
                                                                                       {"--beams", "1"},
                                                                                       {"--rate-hz", "0"},
                                                                                       {"--field-of-view-deg", "361"},
                                                                                       {"--no-return-share", "1.5"},
                                                                                       {"--noise-sd-m", "-1"},
                                                                                       {"--truth", log_.string()},
                                                                                       {"--range-max-m", "far"}}) {
    EXPECT_EQ(run(options), 64) << options[0];
    EXPECT_FALSE(std::filesystem::exists(log_));
  }
  EXPECT_EQ(run({"--rate-hz", "1000", "--beams", "16384"}, "speed 0.01\ngo 0 0  100 0"), 64);
  EXPECT_THAT(said_, HasSubstr("--rate-hz"));
}

TEST_F(SimCommand, AMissingWorldIsExit66AndAMissingFolderExit73) {
  EXPECT_EQ(sim({"no/such.world", "--out", log_.string()}, said_), 66);
  const std::string world = folder_.file("a.world", kWorld).string();
  EXPECT_EQ(sim({world, "--out", "no/such/folder/a.log"}, said_), 73);
}

}  // namespace
}  // namespace odoless
