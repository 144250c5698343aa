// An RPLIDAR session against the emulated laser.
#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "tests/tools/emulate_stream.hpp"
#include "tools/emulate/rplidar_device.hpp"

namespace odoless {
namespace {

using test::Bench;
using test::kMs;
using test::kSecond;

LrfParams rplidar_params(RplidarScan scan = RplidarScan::kUsual) {
  LrfParams params;
  params.driver = LrfDriver::kRplidar;
  params.rplidar_scan = scan;
  return params;
}

/// The scans that a model knows.
std::vector<RplidarScan> scans_of(const RplidarModel& model) {
  std::vector scans{RplidarScan::kUsual, RplidarScan::kStandard};
  if (model.knows_express()) {
    scans.push_back(RplidarScan::kExpress);
  }
  return scans;
}

std::string tested(const RplidarModel& model, RplidarScan scan) {
  return fmt::format("{} {}", model.name, kRplidarScanNames[static_cast<std::size_t>(scan)]);
}

/// The share of beams that differ by more than 2 cm from what the world has.
double wrong_rplidar_share(Bench& bench, const test::HeardScan& scan, std::int64_t index) {
  std::vector<EmulatedBeam> beams;
  for (std::size_t i = 0; i < scan.ranges_m.size(); ++i) {
    beams.push_back({scan.start_angle_rad + static_cast<double>(i) * scan.angle_step_rad, 0});
  }
  std::vector<double> true_m(beams.size());
  bench.source().measure(index, beams, true_m);
  int wrong = 0;
  for (std::size_t i = 0; i < true_m.size(); ++i) {
    wrong += scan.ranges_m[i] == 0.0F || std::abs(scan.ranges_m[i] - true_m[i]) < 0.02 ? 0 : 1;
  }
  return wrong / static_cast<double>(true_m.size());
}

/// Every scan that was heard is one that was sent, with its time; at edges, a beam may see the other surface.
void expect_rplidar_scans_true(Bench& bench, std::int64_t stamp_error_max_ns) {
  for (const test::HeardScan& scan : bench.heard().scans) {
    const SentScan* nearest = nullptr;
    for (const SentScan& sent : bench.sent()) {
      nearest = std::abs(sent.first_beam_ns - scan.stamp_ns) <= stamp_error_max_ns ? &sent : nearest;
    }
    ASSERT_NE(nearest, nullptr) << "no scan was sent with the stamp " << scan.stamp_ns;
    ASSERT_LT(wrong_rplidar_share(bench, scan, nearest->index), 0.05);
  }
}

WorldDrive quiet_rplidar_drive() {
  WorldDrive drive = test::small_drive();
  drive.noise_sd_m = 0.0;
  return drive;
}

TEST(RplidarSession, BringsEveryModelUpAndHearsItsTurns) {
  for (const RplidarModel& model : rplidar_models()) {
    for (const RplidarScan scan : scans_of(model)) {
      SCOPED_TRACE(tested(model, scan));
      Bench bench(std::string(model.name), {}, rplidar_params(scan), quiet_rplidar_drive());
      bench.reset();
      bench.run(5 * kSecond);
      ASSERT_TRUE(bench.session().ready());
      EXPECT_EQ(bench.session().line_baud(), model.baud);
      EXPECT_EQ(bench.heard().events.size(), 1U);
      EXPECT_GE(bench.heard().scans.size(), static_cast<std::size_t>(3500 * kMs / model.turn_ns) - 2U);
      EXPECT_NEAR(static_cast<double>(bench.session().geometry().period_ns), static_cast<double>(model.turn_ns), 1e6);
      expect_rplidar_scans_true(bench, kMs);
      EXPECT_NEAR(static_cast<double>(bench.heard().scans.back().beam_period_ns * 360),
                  static_cast<double>(model.turn_ns), 1e6);
      EXPECT_NEAR(bench.heard().scans[0].angle_step_rad, -std::numbers::pi / 180.0, 1e-7) << "clockwise";
    }
  }
}

TEST(RplidarSession, ComesToTheStreamFromEveryState) {
  const std::string motor = "\xA5\xF0\x02\x94\x02\xC1";
  const std::string scan = "\xA5\x20";
  const std::string express("\xA5\x82\x05\0\0\0\0\0\x22", 9);
  for (const std::string& before : {std::string(), scan, express, std::string("\xA5\x21"), std::string("\xA5\x50"),
                                    std::string("\xA5"), std::string("\xA5\xF0\x02"), std::string("\xA5\x40")}) {
    for (const RplidarScan wished : {RplidarScan::kUsual, RplidarScan::kStandard, RplidarScan::kExpress}) {
      Bench bench("rplidar-a2", {}, rplidar_params(wished));
      bench.say(motor + before);
      bench.run(100 * kMs);
      bench.reset();
      bench.run(2 * kSecond);
      EXPECT_TRUE(bench.session().ready());
      EXPECT_GE(bench.heard().scans.size(), 5U);
    }
  }
}

/// A corridor whose ends are too far to be seen.
WorldDrive long_corridor() {
  WorldDrive drive = quiet_rplidar_drive();
  drive.world = parse_world("room 0 0  60 4\nbox 28 3.2  1 0.3\nspeed 0.01\ngo 30 1.5  30.01 1.5\n", "corridor");
  return drive;
}

/// Least and greatest range within 1.8 degrees of a beam, which are the points beside it at 2000 a second and 10 Hz.
std::pair<double, double> true_around_m(Bench& bench, double angle_rad, double range_far_m) {
  std::vector<EmulatedBeam> beams;
  for (int i = -6; i <= 6; ++i) {
    beams.push_back({angle_rad + i * 0.3 * std::numbers::pi / 180.0, 0});
  }
  std::vector<double> ranges_m(beams.size());
  bench.source().measure(0, beams, ranges_m);
  const auto [least, most] = std::minmax_element(ranges_m.begin(), ranges_m.end());
  constexpr double kFree = std::numeric_limits<double>::infinity();
  return {*least < range_far_m ? *least : kFree, *most < range_far_m ? *most : kFree};
}

// Every turn comes; its walls are walls up to where nothing answers any more, and the rest is free.
TEST(RplidarSession, HearsTurnsWithPointsThatNothingAnswers) {
  for (const RplidarModel& model : rplidar_models()) {
    if (model.range_far_m > 20.0) {
      continue;  // it sees to the corridor's ends, or nearly
    }
    for (const RplidarScan wished : scans_of(model)) {
      SCOPED_TRACE(tested(model, wished));
      Bench bench(std::string(model.name), {}, rplidar_params(wished), long_corridor());
      bench.reset();
      bench.run(5 * kSecond);
      EXPECT_EQ(bench.heard().events.size(), 1U);
      EXPECT_GE(bench.heard().scans.size(), static_cast<std::size_t>(3500 * kMs / model.turn_ns) - 2U);
      for (const test::HeardScan& scan : bench.heard().scans) {
        int free = 0;
        int unknown = 0;
        for (std::size_t i = 0; i < scan.ranges_m.size(); ++i) {
          const double angle_rad = scan.start_angle_rad + static_cast<double>(i) * scan.angle_step_rad;
          const auto [least_m, most_m] = true_around_m(bench, angle_rad, model.range_far_m);
          unknown += scan.ranges_m[i] == 0.0F ? 1 : 0;
          free += std::isinf(least_m) ? 1 : 0;
          if (scan.ranges_m[i] > 0.0F) {
            ASSERT_GE(scan.ranges_m[i], least_m - 0.02) << "beam " << i;
            ASSERT_LE(scan.ranges_m[i], most_m + 0.02) << "beam " << i;
          }
        }
        ASSERT_GT(free, 15);
        ASSERT_LE(unknown, 6);
      }
    }
  }
}

TEST(RplidarSession, TurnsAMotorThatTakesACommandWithoutBeingTold) {
  for (const RplidarModel& model : rplidar_models()) {
    Bench bench(std::string(model.name), {}, rplidar_params());
    bench.reset();
    bench.run(3 * kSecond);
    EXPECT_EQ(static_cast<RplidarDevice&>(bench.device()).motor_duty(), model.motor_duty);
    EXPECT_GE(bench.heard().scans.size(), 2U);
  }
}

TEST(RplidarSession, TurnsAMotorThatSomebodyHasStopped) {
  Bench bench("rplidar-s2", {}, rplidar_params());
  bench.device().set_line_baud(1000000);
  bench.device().receive(std::string("\xA5\xA8\x02\x00\x00\x0F", 6), bench.now_ns());
  ASSERT_EQ(static_cast<RplidarDevice&>(bench.device()).speed_rpm(), 0);
  bench.reset();
  bench.run(3 * kSecond);
  EXPECT_EQ(static_cast<RplidarDevice&>(bench.device()).speed_rpm(), 600);
  EXPECT_GE(bench.heard().scans.size(), 10U);
}

TEST(RplidarSession, AsksOldFirmwareForTheBestThatItKnows) {
  for (const auto& [model, sample_request] :
       {std::pair("rplidar-a1-1.20", "\xA5\x82"), {"rplidar-a1-1.16", "\xA5\x20"}}) {
    Bench bench(model, {}, rplidar_params());
    bench.reset();
    bench.run(3 * kSecond);
    EXPECT_TRUE(bench.session().ready());
    EXPECT_THAT(bench.written(), ::testing::HasSubstr(sample_request)) << model;
  }
}

TEST(RplidarSession, TellsOnceThatTheDeviceDoesNotKnowTheExpressScan) {
  Bench bench("rplidar-a1-1.16", {}, rplidar_params(RplidarScan::kExpress));
  bench.reset();
  bench.run(5 * kSecond);
  EXPECT_FALSE(bench.session().ready());
  ASSERT_EQ(bench.heard().events.size(), 1U);
  EXPECT_EQ(bench.heard().events[0].type, LrfEventType::kLost);
  EXPECT_EQ(bench.heard().events[0].reason, Errc::kDeviceSilent);
}

TEST(RplidarSession, TurnsTheMotorWhereThatIsACommand) {
  LrfParams params = rplidar_params();
  params.rplidar_pwm = 700;
  Bench bench("rplidar-a2", {}, params);
  bench.reset();
  bench.run(kSecond);
  EXPECT_EQ(static_cast<RplidarDevice&>(bench.device()).motor_duty(), 700);
  EXPECT_TRUE(bench.session().ready());
}

TEST(RplidarSession, GivesAsManyBeamsAsAreWished) {
  LrfParams params = rplidar_params(RplidarScan::kExpress);
  params.rplidar_beams = 720;
  Bench bench("rplidar-a1", {}, params, quiet_rplidar_drive());
  bench.reset();
  bench.run(2 * kSecond);
  ASSERT_FALSE(bench.heard().scans.empty());
  EXPECT_EQ(bench.heard().scans[0].ranges_m.size(), 720U);
  expect_rplidar_scans_true(bench, kMs);
}

TEST(RplidarSession, ResetsADeviceThatSaysItIsBroken) {
  Bench bench("rplidar-a1", {}, rplidar_params());
  bool is_broken = true;
  bench.on_the_way = [&](std::string& bytes) {
    if (is_broken && bytes.size() == 10 && bytes[6] == 6) {
      bytes[7] = 2;
      is_broken = false;
    }
  };
  bench.reset();
  bench.run(5 * kSecond);
  EXPECT_TRUE(bench.session().ready());
  EXPECT_EQ(bench.heard().count(LrfEventType::kDeviceError), 1);
  EXPECT_THAT(bench.written(), ::testing::HasSubstr("\xA5\x40"));
}

TEST(RplidarSession, HuntsForTheRateOfASilentDevice) {
  const auto session = make_lrf_session(rplidar_params(), 2048);
  test::Heard heard;
  session->reset(0);
  std::vector<int> rates;
  for (std::int64_t now_ns = 0; now_ns < 2 * kSecond; now_ns += kMs) {
    if (rates.empty() || rates.back() != session->line_baud()) {
      rates.push_back(session->line_baud());
    }
    static_cast<void>(session->transmit());
    session->tick(now_ns, heard);
  }
  EXPECT_THAT(rates, ::testing::IsSupersetOf({115200, 256000, 460800, 1000000}));
  EXPECT_EQ(heard.count(LrfEventType::kLost), 1) << "silence is told once";
}

/// How often the device is asked for the packets of a mode, where something stops it 2 s into its stream; its
/// information goes through `on_the_way`.
int lists_asked(const std::function<void(std::string&)>& on_the_way) {
  Bench bench("rplidar-a3", {.faults = {parse_fault("silence@2:1")}}, rplidar_params());
  bench.on_the_way = on_the_way;
  bench.reset();
  bench.run(6 * kSecond);
  EXPECT_TRUE(bench.session().ready());
  EXPECT_EQ(bench.heard().count(LrfEventType::kReady), 2);
  const std::string question("\xA5\x84\x06\x75\0\0\0", 7);
  int found = 0;
  for (std::size_t at = bench.written().find(question); at != std::string::npos;
       at = bench.written().find(question, at + 1)) {
    ++found;
  }
  return found;
}

TEST(RplidarSession, AsksADeviceOnceWhichModesItHasAndAnotherDeviceAnew) {
  EXPECT_EQ(lists_asked([](std::string&) {}), 1);
  int infos = 0;
  EXPECT_EQ(lists_asked([&infos](std::string& bytes) {
              if (bytes.size() == 27 && bytes[6] == 4 && ++infos > 1) {
                bytes.back() = '2';  // its serial number
              }
            }),
            2);
}

class RplidarSessionFault : public ::testing::TestWithParam<test::FaultCase> {};

// Two seconds into the stream, a fault; in the end the stream runs again.
TEST_P(RplidarSessionFault, IsSurvived) {
  for (const RplidarScan scan : {RplidarScan::kStandard, RplidarScan::kExpress}) {
    Bench bench("rplidar-a2", {.faults = {parse_fault(GetParam().fault)}}, rplidar_params(scan), quiet_rplidar_drive());
    bench.reset();
    bench.run(9 * kSecond);
    EXPECT_TRUE(bench.session().ready());
    // From the first turn to the last: the one that is on its way is not lost.
    const std::int64_t heard_ns = bench.heard().scans.back().stamp_ns - bench.heard().scans.front().stamp_ns;
    const int sent = 1 + static_cast<int>(std::lround(static_cast<double>(heard_ns) / (100 * kMs)));
    EXPECT_LE(sent - static_cast<int>(bench.heard().scans.size()), GetParam().scans_lost_max)
        << kRplidarScanNames[static_cast<std::size_t>(scan)];
    EXPECT_LT(bench.now_ns() - bench.heard().scans.back().arrival_ns, 120 * kMs);
    for (const test::HeardScan& heard : bench.heard().scans) {
      const auto index = std::llround(static_cast<double>(heard.stamp_ns - bench.sent()[0].first_beam_ns) / 1e8) +
                         bench.sent()[0].index;
      double least = 1.0;  // after bytes that were lost, stamps lag until that is known
      for (std::int64_t i = index; i < index + 6; ++i) {
        least = std::min(least, wrong_rplidar_share(bench, heard, i));
      }
      ASSERT_LT(least, 0.05);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Rplidar, RplidarSessionFault,
                         ::testing::Values(test::FaultCase{"silence@2:1", 22}, test::FaultCase{"garbage@2:1", 22},
                                           test::FaultCase{"truncate@2:0.2", 6}, test::FaultCase{"reboot@2", 15},
                                           test::FaultCase{"beams@2:0.3", 6}, test::FaultCase{"one-byte@2:1", 2}),
                         test::fault_name);

/// The most beams by which a heard scan differs by more than 1 cm from the one that was sent, scan by scan in order;
/// beams of which the session says nothing are not wrong.
int most_wrong_beams(const std::vector<test::HeardScan>& heard, const std::vector<test::HeardScan>& sent) {
  int most = 0;
  std::size_t next = 0;
  for (const test::HeardScan& scan : heard) {
    int least = 100'000;
    for (std::size_t i = next; i < sent.size(); ++i) {
      int wrong = 0;
      for (std::size_t beam = 0; beam < scan.ranges_m.size(); ++beam) {
        const float heard_m = scan.ranges_m[beam];
        const float sent_m = sent[i].ranges_m[beam];
        wrong += heard_m == 0.0F || heard_m == sent_m || std::abs(heard_m - sent_m) < 0.01F ? 0 : 1;
      }
      if (wrong < least) {
        least = wrong;
        next = i;
      }
    }
    most = std::max(most, least);
    ++next;
  }
  return most;
}

/// The standard scan has no sums: a damaged byte may move one point, but not more.
void expect_a_damaged_byte_costs_one_scan(const WorldDrive& drive) {
  for (const RplidarScan scan : {RplidarScan::kStandard, RplidarScan::kExpress}) {
    const bool is_standard = scan == RplidarScan::kStandard;
    const test::Stream stream("rplidar-a2", rplidar_params(scan), 650 * kMs, drive);
    const std::size_t turn_bytes = stream.scans().size() * 100 / 650;
    const std::vector<test::HeardScan> sent = heard_from(stream, stream.scans(), turn_bytes / 4);
    ASSERT_GE(sent.size(), 5U);
    Rng rng(3);
    for (const auto& [name, mutate] : test::kMutations) {
      for (std::size_t at = 2 * turn_bytes; at < 3 * turn_bytes + 100; at += 3) {
        const std::vector<test::HeardScan> heard = heard_from(stream, mutate(stream.scans(), at, rng), turn_bytes / 4);
        ASSERT_GE(heard.size() + 1, sent.size()) << name << " at " << at;
        ASSERT_LE(most_wrong_beams(heard, sent), is_standard ? 8 : 4) << name << " at " << at;
      }
    }
  }
}

TEST(RplidarRobustness, OneDamagedByteAnywhereCostsAtMostOneScan) {
  expect_a_damaged_byte_costs_one_scan(test::small_drive());
}

TEST(RplidarRobustness, TheSameWhereMuchDoesNotAnswer) {
  WorldDrive drive = long_corridor();
  drive.noise_sd_m = 0.01;  // no two scans are the same
  expect_a_damaged_byte_costs_one_scan(drive);
}

TEST(RplidarRobustness, AnySplitGivesTheSame) {
  for (const RplidarScan scan : {RplidarScan::kStandard, RplidarScan::kExpress}) {
    test::expect_any_split_gives_the_same({"rplidar-a2", rplidar_params(scan), 650 * kMs}, 30, 5000);
  }
}

TEST(RplidarRobustness, NoiseNeverEndsTheSession) {
  const std::string alphabet("\xA5\x5A\x05\x00\x40\x81\x54\x82\x14\x04\x03\x06\x01\x02", 14);
  for (const RplidarScan scan : {RplidarScan::kStandard, RplidarScan::kExpress}) {
    test::expect_noise_never_ends(rplidar_params(scan), alphabet, 16);
  }
}

}  // namespace
}  // namespace odoless
