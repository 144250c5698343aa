// A YDLIDAR session against the emulated laser.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/tools/emulate_stream.hpp"
#include "tools/emulate/ydlidar_device.hpp"

namespace odoless {
namespace {

using test::Bench;
using test::kMs;
using test::kSecond;

constexpr int kBeams = 450;

LrfParams ydlidar_params(const YdlidarModel& model, int baud = 0) {
  LrfParams params;
  params.driver = LrfDriver::kYdlidar;
  params.baud = baud;
  params.ydlidar_ranging = model.triangulates ? LrfRanging::kTriangle : LrfRanging::kTimeOfFlight;
  return params;
}

LrfParams x4_params() { return ydlidar_params(*find_ydlidar_model("ydlidar-x4")); }

WorldDrive quiet_drive() {
  WorldDrive drive = test::small_drive();
  drive.noise_sd_m = 0.0;
  return drive;
}

/// The worst of the stamps against those of what was sent.
double worst_stamp_ms(const Bench& bench, std::size_t from_scan) {
  double worst_ms = 0.0;
  for (std::size_t i = from_scan; i < bench.heard().scans.size(); ++i) {
    double error_ms = 1e9;
    for (const SentScan& sent : bench.sent()) {
      const auto off_ns = static_cast<double>(sent.first_beam_ns - bench.heard().scans[i].stamp_ns);
      error_ms = std::min(error_ms, std::abs(off_ns) * 1e-6);
    }
    worst_ms = std::max(worst_ms, error_ms);
  }
  return worst_ms;
}

TEST(YdlidarSession, FindsEveryModelAtItsRateAndHearsItsTurns) {
  for (const YdlidarModel& model : ydlidar_models()) {
    for (const int baud : {0, model.baud}) {
      SCOPED_TRACE(std::string(model.name) + " " + std::to_string(baud));
      Bench bench(std::string(model.name), {}, ydlidar_params(model, baud), quiet_drive());
      bench.reset();
      bench.run(8 * kSecond);
      ASSERT_TRUE(bench.session().ready());
      EXPECT_EQ(bench.session().line_baud(), model.baud);
      EXPECT_EQ(bench.heard().count(LrfEventType::kLost), 0);
      EXPECT_GE(bench.heard().scans.size(), 35U);
      EXPECT_LT(worst_stamp_ms(bench, 20), 1.5);
      EXPECT_NEAR(static_cast<double>(bench.session().geometry().period_ns), static_cast<double>(model.turn_ns),
                  0.005 * static_cast<double>(model.turn_ns));
      EXPECT_NEAR(bench.heard().scans[0].angle_step_rad, -2.0 * std::numbers::pi / kBeams, 1e-7) << "clockwise";
    }
  }
}

TEST(YdlidarSession, TellsADeviceThatTakesCommandsToScanAndNoOther) {
  for (const YdlidarModel& model : ydlidar_models()) {
    Bench bench(std::string(model.name), {}, ydlidar_params(model, model.baud));
    bench.reset();
    bench.run(2 * kSecond);
    EXPECT_EQ(bench.written(), model.takes_commands ? "\xA5\x60" : "") << model.name;
    EXPECT_TRUE(bench.session().ready());
  }
}

TEST(YdlidarSession, TellsADeviceThatStreamsNothing) {
  Bench bench("ydlidar-x4", {}, x4_params());
  bench.say("\xA5\x60");
  bench.run(kSecond);
  bench.reset();
  const std::size_t written = bench.written().size();
  bench.run(kSecond);
  EXPECT_TRUE(bench.session().ready());
  EXPECT_EQ(bench.written().size(), written);
}

TEST(YdlidarSession, RefusesMoreBeamsThanThereIsRoomFor) {
  LrfParams params = x4_params();
  params.ydlidar_beams = 3000;  // of 2048
  Bench bench("ydlidar-x4", {}, params);
  bench.reset();
  bench.run(3 * kSecond);
  EXPECT_FALSE(bench.session().ready());
  ASSERT_FALSE(bench.heard().events.empty());
  for (const LrfEvent& event : bench.heard().events) {
    EXPECT_EQ(event.reason, Errc::kTooManyBeams);
  }
}

TEST(YdlidarSession, IsInfiniteWhereNothingAnswers) {
  WorldDrive drive = quiet_drive();
  drive.world = parse_world("room 0 0  60 4\nspeed 0.01\ngo 30 1.5  30.01 1.5\n", "corridor");
  Bench bench("ydlidar-x4", {}, x4_params(), drive);
  bench.reset();
  bench.run(4 * kSecond);
  ASSERT_GE(bench.heard().scans.size(), 10U);
  for (const test::HeardScan& scan : bench.heard().scans) {
    EXPECT_TRUE(std::isinf(scan.ranges_m[0]));
    EXPECT_TRUE(std::isinf(scan.ranges_m[kBeams / 2]));
    EXPECT_NEAR(scan.ranges_m[kBeams / 4], 1.5, 0.02) << "clockwise: right";
  }
}

TEST(YdlidarSession, TellsSilenceOnceAndSearchesAtEveryRate) {
  const auto session = make_lrf_session(x4_params(), 2048);
  test::Heard heard;
  session->reset(0);
  std::vector<int> rates;
  for (std::int64_t now_ns = 0; now_ns < 4 * kSecond; now_ns += kMs) {
    if (rates.empty() || rates.back() != session->line_baud()) {
      rates.push_back(session->line_baud());
    }
    session->tick(now_ns, heard);
    EXPECT_LE(session->transmit().size(), 2U);
  }
  EXPECT_THAT(rates, ::testing::IsSupersetOf({115200, 128000, 230400, 512000}));
  EXPECT_EQ(heard.count(LrfEventType::kLost), 1);
}

class YdlidarSessionFault : public ::testing::TestWithParam<test::FaultCase> {};

// Three seconds into the stream, a fault; in the end the stream runs again, and its stamps are right.
TEST_P(YdlidarSessionFault, IsSurvived) {
  Bench bench("ydlidar-x4", {.faults = {parse_fault(GetParam().fault)}}, x4_params(), quiet_drive());
  bench.reset();
  bench.run(12 * kSecond);
  EXPECT_TRUE(bench.session().ready());
  const auto sent = static_cast<int>((bench.now_ns() - bench.heard().scans.front().stamp_ns) / (143 * kMs));
  EXPECT_LE(sent - static_cast<int>(bench.heard().scans.size()), GetParam().scans_lost_max);
  EXPECT_LT(bench.now_ns() - bench.heard().scans.back().arrival_ns, 180 * kMs);
  EXPECT_LT(worst_stamp_ms(bench, bench.heard().scans.size() - 10), 2.0);
}

INSTANTIATE_TEST_SUITE_P(Ydlidar, YdlidarSessionFault,
                         ::testing::Values(test::FaultCase{"silence@3:1", 20}, test::FaultCase{"silence@3:0.3", 6},
                                           test::FaultCase{"garbage@3:1", 20}, test::FaultCase{"truncate@3:0.2", 6},
                                           test::FaultCase{"wrong-sum@3:0.2", 6}, test::FaultCase{"reboot@3", 30},
                                           test::FaultCase{"beams@3:0.3", 6}, test::FaultCase{"one-byte@3:1", 2}),
                         test::fault_name);

/// What is heard where the line's bytes come in pieces of chance sizes, each when its last byte has come.
std::vector<test::HeardScan> heard_in_pieces(const test::Stream& stream, std::int64_t duration_ns,
                                             std::uint32_t piece_max_bytes) {
  test::Heard heard;
  const auto session = stream.ready_session(heard);
  const std::int64_t byte_ns = duration_ns / static_cast<std::int64_t>(stream.scans().size());
  Rng rng(5);
  std::int64_t now_ns = 20 * kSecond;
  for (std::string_view rest = stream.scans(); !rest.empty();) {
    const std::string_view piece = rest.substr(0, 1 + rng.below(piece_max_bytes));
    now_ns += static_cast<std::int64_t>(piece.size()) * byte_ns;
    test::Stream::give(*session, piece, now_ns, heard);
    rest.remove_prefix(piece.size());
  }
  EXPECT_TRUE(heard.events.empty());
  return heard.scans;
}

// The first scan comes when the samples' rate is known, which may be a turn earlier or later.
TEST(YdlidarRobustness, AnySplitGivesTheSame) {
  constexpr std::int64_t kDurationNs = 3 * kSecond;
  const test::Stream stream("ydlidar-x4", x4_params(), kDurationNs);
  const std::vector<test::HeardScan> one_by_one = heard_in_pieces(stream, kDurationNs, 1);
  ASSERT_GE(one_by_one.size(), 14U);
  for (const std::uint32_t piece_max_bytes : {10U, 50U, 200U, 1000U}) {
    std::vector<test::HeardScan> heard = heard_in_pieces(stream, kDurationNs, piece_max_bytes);
    EXPECT_NEAR(static_cast<double>(heard.size()), static_cast<double>(one_by_one.size()), 1.0);
    heard.erase(heard.begin());
    EXPECT_TRUE(test::are_among(heard, one_by_one)) << piece_max_bytes;
  }
}

TEST(YdlidarRobustness, NoiseNeverEndsTheSession) {
  test::expect_noise_never_ends(x4_params(), std::string("\xAA\x55\xAA\x55\x00\x01\x28\x03", 8), 2);
}

}  // namespace
}  // namespace odoless
