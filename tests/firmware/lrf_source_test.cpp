#include "firmware/sources/lrf_source.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>
#include <string>

#include "tests/firmware/lrf_bench.hpp"

namespace odoless {
namespace {

using test::BabblingDevice;
using test::Bench;
using test::DeadDevice;
using test::kMs;
using test::kSecond;
using test::sick_params;
using test::SlowSick;

TEST(LrfSource, NothingArrivesBeforeItWasSentHoweverItsThreadIsHeldUp) {
  SlowSick laser;
  Bench bench(laser);
  bench.run(30 * kSecond);
  const std::size_t scans = bench.heard.stamps_ns.size();
  ASSERT_GT(scans, 5U);
  const std::int64_t usual_ns = bench.heard.stamps_ns.back() - laser.sent_ns[scans - 1];
  bench.hold_up(38 * kMs);
  bench.run(30 * kSecond);
  ASSERT_GT(bench.heard.stamps_ns.size(), scans + 50);
  for (std::size_t i = scans; i < bench.heard.stamps_ns.size(); ++i) {
    ASSERT_GE(bench.heard.stamps_ns[i] - laser.sent_ns[i], usual_ns - 5 * kMs) << i;  // a step of the bench
  }
}

TEST(LrfSource, NeverCutsOffWhatASlowLaserIsAt) {
  SlowSick laser;
  Bench bench(laser);
  bench.run(40 * kSecond);
  EXPECT_EQ(laser.writes, 1) << "its memory wears";
  EXPECT_EQ(bench.reopened, 0);
  EXPECT_GT(bench.heard.scans, 20);
  EXPECT_THAT(bench.heard.told, ::testing::ElementsAre("laser: streaming, 181 beams"));
}

// It was looked for in vain at first, and so the line may be opened anew; but not while the laser is at something.
TEST(LrfSource, NeverCutsOffALaserThatIsSwitchedOnLater) {
  for (const std::int64_t later_ns : {300 * kMs, 1500 * kMs, 1900 * kMs, 5 * kSecond, 60 * kSecond}) {
    SCOPED_TRACE(later_ns / kMs);
    SlowSick laser;
    LrfParams params = sick_params();
    params.device = "tcp://127.0.0.1:1";  // without a rate that would have to be searched for
    laser.is_off = true;
    Bench bench(laser, params);
    bench.run(later_ns);
    laser.is_off = false;
    bench.run(40 * kSecond);
    EXPECT_EQ(laser.writes, 1);
    EXPECT_GT(bench.heard.scans, 20);
  }
}

TEST(LrfSource, OpensADeadLineAnewEveryTwoSecondsAndTellsOfItOnceAnOutage) {
  SlowSick laser;
  Bench bench(laser);
  bench.run(40 * kSecond);
  for (int outage = 1; outage <= 2; ++outage) {
    SCOPED_TRACE(outage);
    bench.run(1 * kSecond);
    const int scans = bench.heard.scans;
    laser.is_off = true;
    EXPECT_LE(bench.run_until_reopened(10 * kSecond), 2500 * kMs);
    const int before = bench.reopened;
    bench.run(60 * kSecond);
    EXPECT_GE(bench.reopened - before, 24);
    EXPECT_EQ(bench.heard.times("no data"), outage);
    EXPECT_EQ(bench.heard.times("opened again"), outage);
    laser.is_off = false;
    bench.run(40 * kSecond);
    EXPECT_GT(bench.heard.scans, scans);
  }
  EXPECT_EQ(bench.heard.told.size(), 7U) << ::testing::PrintToString(bench.heard.told);
}

TEST(LrfSource, OpensALineAnewThatOnlyBabbles) {
  for (const LrfDriver driver :
       {LrfDriver::kScip, LrfDriver::kSick, LrfDriver::kRplidar, LrfDriver::kLdrobot, LrfDriver::kYdlidar}) {
    SCOPED_TRACE(static_cast<int>(driver));
    BabblingDevice noise;
    LrfParams params = sick_params();
    params.driver = driver;
    Bench bench(noise, params);
    EXPECT_LE(bench.run_until_reopened(10 * kSecond), 4 * kSecond);
    bench.run(60 * kSecond);
    EXPECT_EQ(bench.heard.times("opened again"), 1);
    EXPECT_LE(bench.heard.told.size(), 4U) << ::testing::PrintToString(bench.heard.told);
  }
}

TEST(LrfSource, OpensADeadLineAnewInAboutTwoSecondsWhateverTheLaser) {
  for (const LrfDriver driver :
       {LrfDriver::kScip, LrfDriver::kSick, LrfDriver::kRplidar, LrfDriver::kLdrobot, LrfDriver::kYdlidar}) {
    SCOPED_TRACE(static_cast<int>(driver));
    DeadDevice dead;
    LrfParams params = sick_params();
    params.driver = driver;
    Bench bench(dead, params);
    EXPECT_LE(bench.run_until_reopened(10 * kSecond), 2300 * kMs);
  }
}

TEST(LrfSource, WaitsAsLongAsTheStallTimeoutSays) {
  SlowSick laser;
  LrfParams params = sick_params();
  params.stall_timeout_ns = 10 * kSecond;
  Bench bench(laser, params);
  bench.run(40 * kSecond);
  laser.is_off = true;
  bench.run(8 * kSecond);
  laser.is_off = false;
  const int scans = bench.heard.scans;
  bench.run(3 * kSecond);
  EXPECT_GT(bench.heard.scans, scans + 4);
  EXPECT_EQ(bench.reopened, 0);
  EXPECT_EQ(bench.heard.told.size(), 1U) << ::testing::PrintToString(bench.heard.told);
}

TEST(LrfSource, TellsOnceWhyALaserIsRefusedAndCountsIt) {
  SlowSick laser;
  Bench bench(laser, sick_params(), 100);
  bench.run(120 * kSecond);
  EXPECT_EQ(bench.heard.scans, 0);
  EXPECT_THAT(bench.heard.told, ::testing::ElementsAre(::testing::HasSubstr("scan.beams_max")));
  EXPECT_GE(bench.rejected(), 5);
}

TEST(LrfSource, TellsOnceThatItsLineTakesNothing) {
  DeadDevice dead;
  Bench bench(dead);
  bench.run(20 * kMs);
  bench.fill();
  bench.run(1500 * kMs);
  EXPECT_EQ(bench.heard.times("does not take"), 1);
}

}  // namespace
}  // namespace odoless
