// An LDROBOT session against the emulated laser.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/tools/emulate_stream.hpp"
#include "tools/emulate/ldrobot_device.hpp"

namespace odoless {
namespace {

using test::Bench;
using test::kMs;
using test::kSecond;

LrfParams ldrobot_params(int baud = 0) {
  LrfParams params;
  params.driver = LrfDriver::kLdrobot;
  params.baud = baud;
  return params;
}

WorldDrive quiet_drive() {
  WorldDrive drive = test::small_drive();
  drive.noise_sd_m = 0.0;
  return drive;
}

/// The share of beams that differ by more than 2 cm from what the world has; at edges, a beam may see the other
/// surface.
double wrong_share(Bench& bench, const test::HeardScan& scan, std::int64_t index) {
  std::vector<EmulatedBeam> beams;
  for (std::size_t i = 0; i < scan.ranges_m.size(); ++i) {
    beams.push_back({scan.start_angle_rad + static_cast<double>(i) * scan.angle_step_rad,
                     static_cast<std::int64_t>(i) * scan.beam_period_ns});
  }
  std::vector<double> true_m(beams.size());
  bench.source().measure(index, beams, true_m);
  int wrong = 0;
  for (std::size_t i = 0; i < true_m.size(); ++i) {
    wrong += scan.ranges_m[i] == 0.0F || std::abs(scan.ranges_m[i] - true_m[i]) < 0.02 ? 0 : 1;
  }
  return wrong / static_cast<double>(true_m.size());
}

/// Every scan that was heard is one that was sent, with its time.
void expect_ldrobot_scans_true(Bench& bench, std::int64_t stamp_error_max_ns) {
  for (const test::HeardScan& scan : bench.heard().scans) {
    const SentScan* nearest = nullptr;
    for (const SentScan& sent : bench.sent()) {
      nearest = std::abs(sent.first_beam_ns - scan.stamp_ns) <= stamp_error_max_ns ? &sent : nearest;
    }
    ASSERT_NE(nearest, nullptr) << "no scan was sent with the stamp " << scan.stamp_ns;
    ASSERT_LT(wrong_share(bench, scan, nearest->index), 0.05);
  }
}

TEST(LdrobotSession, FindsTheStreamOfEveryModelAtItsRateAndHearsItsTurns) {
  for (const LdrobotModel& model : ldrobot_models()) {
    for (const int baud : {0, model.baud}) {
      SCOPED_TRACE(std::string(model.name) + " " + std::to_string(baud));
      Bench bench(std::string(model.name), {}, ldrobot_params(baud), quiet_drive());
      bench.reset();
      bench.run(4 * kSecond);
      ASSERT_TRUE(bench.session().ready());
      EXPECT_EQ(bench.session().line_baud(), model.baud);
      EXPECT_EQ(bench.session().geometry().range_max_m, model.range_far_m);
      EXPECT_EQ(bench.heard().events.size(), 1U) << "it is ready";
      EXPECT_GE(bench.heard().scans.size(), 34U);
      expect_ldrobot_scans_true(bench, kMs);
      EXPECT_NEAR(static_cast<double>(bench.session().geometry().period_ns), 1e8, 2e5);
      EXPECT_NEAR(bench.heard().scans[0].angle_step_rad, -2.0 * std::numbers::pi / 450.0, 1e-7) << "clockwise";
      EXPECT_NEAR(static_cast<double>(bench.heard().scans.back().beam_period_ns * 450), 1e8, 1e6);
      EXPECT_TRUE(bench.written().empty()) << "it takes no commands";
    }
  }
}

TEST(LdrobotSession, GivesAsManyBeamsAsAreWished) {
  LrfParams params = ldrobot_params();
  params.ldrobot_beams = 2000;
  Bench bench("stl-27l", {}, params, quiet_drive());
  bench.reset();
  bench.run(2 * kSecond);
  ASSERT_FALSE(bench.heard().scans.empty());
  EXPECT_EQ(bench.heard().scans[0].ranges_m.size(), 2000U);
  expect_ldrobot_scans_true(bench, kMs);
}

TEST(LdrobotSession, RefusesMoreBeamsThanThereIsRoomFor) {
  LrfParams params = ldrobot_params();
  params.ldrobot_beams = 3000;  // of 2048
  Bench bench("ld06", {}, params);
  bench.reset();
  bench.run(3 * kSecond);
  EXPECT_FALSE(bench.session().ready());
  ASSERT_FALSE(bench.heard().events.empty());
  for (const LrfEvent& event : bench.heard().events) {
    EXPECT_EQ(event.reason, Errc::kTooManyBeams);
  }
}

TEST(LdrobotSession, IsInfiniteWhereNothingAnswers) {
  WorldDrive drive = quiet_drive();
  drive.world = parse_world("room 0 0  60 4\nspeed 0.01\ngo 30 1.5  30.01 1.5\n", "corridor");
  Bench bench("ld06", {}, ldrobot_params(), drive);
  bench.reset();
  bench.run(2 * kSecond);
  ASSERT_GE(bench.heard().scans.size(), 10U);
  for (const test::HeardScan& scan : bench.heard().scans) {
    const auto free = std::ranges::count_if(scan.ranges_m, [](float range_m) { return std::isinf(range_m); });
    EXPECT_NEAR(static_cast<double>(free), 450.0 * (9.5 + 13.0) / 180.0, 12.0) << "beyond 12 m";
    EXPECT_TRUE(std::isinf(scan.ranges_m[0]));
    EXPECT_TRUE(std::isinf(scan.ranges_m[225]));
  }
}

// 40 s, so that the counter wraps, at a rate that is another than it says.
TEST(LdrobotSession, StampsStayRightThoughItsClockRunsFastAndWraps) {
  Bench bench("ld06", {.faults = {parse_fault("drift=300@5")}}, ldrobot_params(), quiet_drive());
  bench.reset();
  bench.run(40 * kSecond);
  EXPECT_GE(bench.heard().scans.size(), 392U);
  for (const test::HeardScan& scan : bench.heard().scans) {
    double error_ms = 1e9;
    for (const SentScan& sent : bench.sent()) {
      error_ms = std::min(error_ms, std::abs(static_cast<double>(sent.first_beam_ns - scan.stamp_ns)) * 1e-6);
    }
    ASSERT_LT(error_ms, 1.2);
  }
}

TEST(LdrobotSession, TellsSilenceOnceAndSearchesAtBothRates) {
  const auto session = make_lrf_session(ldrobot_params(), 2048);
  test::Heard heard;
  session->reset(0);
  std::vector<int> rates;
  for (std::int64_t now_ns = 0; now_ns < 2 * kSecond; now_ns += kMs) {
    if (rates.empty() || rates.back() != session->line_baud()) {
      rates.push_back(session->line_baud());
    }
    session->tick(now_ns, heard);
    EXPECT_TRUE(session->transmit().empty());
  }
  EXPECT_THAT(rates, ::testing::IsSupersetOf({230400, 921600}));
  EXPECT_EQ(heard.count(LrfEventType::kLost), 1);
}

class LdrobotSessionFault : public ::testing::TestWithParam<test::FaultCase> {};

// Two seconds into the stream, a fault; in the end the stream runs again, and no scan that was heard is wrong.
TEST_P(LdrobotSessionFault, IsSurvived) {
  Bench bench("ld19", {.faults = {parse_fault(GetParam().fault)}}, ldrobot_params(), quiet_drive());
  bench.reset();
  bench.run(9 * kSecond);
  EXPECT_TRUE(bench.session().ready());
  const std::int64_t first_ns = bench.heard().scans.front().stamp_ns;
  const auto sent = static_cast<int>((bench.now_ns() - first_ns) / (100 * kMs));
  EXPECT_LE(sent - static_cast<int>(bench.heard().scans.size()), GetParam().scans_lost_max);
  EXPECT_LT(bench.now_ns() - bench.heard().scans.back().arrival_ns, 120 * kMs);
  expect_ldrobot_scans_true(bench, 4 * kMs);
}

INSTANTIATE_TEST_SUITE_P(Ldrobot, LdrobotSessionFault,
                         ::testing::Values(test::FaultCase{"silence@2:1", 15}, test::FaultCase{"garbage@2:1", 15},
                                           test::FaultCase{"truncate@2:0.2", 5}, test::FaultCase{"wrong-sum@2:0.2", 5},
                                           test::FaultCase{"reboot@2", 8}, test::FaultCase{"beams@2:0.3", 6},
                                           test::FaultCase{"one-byte@2:1", 2}),
                         test::fault_name);

TEST(LdrobotRobustness, OneDamagedByteAnywhereCostsAtMostItsPacket) {
  const test::Stream stream("ld06", ldrobot_params(), 650 * kMs);
  const std::size_t turn_bytes = stream.scans().size() * 100 / 650;
  const std::vector<test::HeardScan> sent = heard_from(stream, stream.scans(), turn_bytes / 4);
  ASSERT_GE(sent.size(), 5U);
  Rng rng(3);
  for (const auto& [name, mutate] : test::kMutations) {
    for (std::size_t at = 2 * turn_bytes; at < 3 * turn_bytes + 60; at += 7) {
      const std::vector<test::HeardScan> heard = heard_from(stream, mutate(stream.scans(), at, rng), turn_bytes / 4);
      ASSERT_EQ(heard.size(), sent.size()) << name << " at " << at;
      int different = 0;
      for (std::size_t scan = 0; scan < sent.size(); ++scan) {
        for (std::size_t beam = 0; beam < 450; ++beam) {
          const float was_m = sent[scan].ranges_m[beam];
          const float is_m = heard[scan].ranges_m[beam];
          different += is_m == was_m || is_m == 0.0F || std::abs(is_m - was_m) < 0.01F ? 0 : 1;
        }
      }
      ASSERT_LE(different, 4) << name << " at " << at << ": beside what was lost";
    }
  }
}

TEST(LdrobotRobustness, AnySplitGivesTheSame) {
  test::expect_any_split_gives_the_same({"ld06", ldrobot_params(), 650 * kMs}, 30, 5000);
}

TEST(LdrobotRobustness, NoiseNeverEndsTheSession) {
  test::expect_noise_never_ends(ldrobot_params(), std::string("\x54\x2C\x54\x2C\x10\x0E\x00\x01", 8), 1);
}

}  // namespace
}  // namespace odoless
