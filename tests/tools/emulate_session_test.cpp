#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <cmath>

#include "drivers/lrf/scip/number.hpp"
#include "drivers/lrf/scip/replies.hpp"
#include "tests/tools/emulate_stream.hpp"
#include "tests/tools/emulate_support.hpp"
#include "tools/emulate/log_source.hpp"

namespace odoless {
namespace {

using test::Bench;
using test::kMs;
using test::kSecond;

/// Every scan that was heard is one that was sent: its beams within what noise-free millimetres allow, its stamp within
/// `stamp_ns` of the moment of the first beam.
void expect_scans_true(Bench& bench, std::int64_t stamp_error_max_ns) {
  std::vector<double> true_m(static_cast<std::size_t>(bench.model().beams()));
  for (const test::HeardScan& scan : bench.heard().scans) {
    const SentScan* nearest = nullptr;
    for (const SentScan& sent : bench.sent()) {
      if (std::abs(sent.first_beam_ns - scan.stamp_ns) <= stamp_error_max_ns) {
        nearest = &sent;
      }
    }
    ASSERT_NE(nearest, nullptr) << "no scan was sent with the stamp " << scan.stamp_ns;
    bench.source().measure(nearest->index, bench.model().beam_list(), true_m);
    ASSERT_EQ(scan.ranges_m.size(), true_m.size());
    for (std::size_t i = 0; i < true_m.size(); ++i) {
      if (true_m[i] * 1000.0 < bench.model().range_far_mm) {
        ASSERT_NEAR(scan.ranges_m[i], true_m[i], 0.00051) << "beam " << i;
      } else {
        ASSERT_TRUE(std::isinf(scan.ranges_m[i])) << "beam " << i;
      }
    }
  }
}

TEST(ScipSession, BringsEveryModelUpAndHearsItsScans) {
  for (const ScipModel& model : scip_models()) {
    SCOPED_TRACE(model.name);
    Bench bench{std::string(model.name)};
    bench.reset();
    bench.run(3 * kSecond);
    EXPECT_TRUE(bench.session().ready());
    EXPECT_EQ(bench.heard().count(LrfEventType::kReady), 1);
    EXPECT_EQ(bench.heard().events.size(), 1U);
    EXPECT_GT(static_cast<double>(bench.heard().scans.size()), 2.7 * model.turns_per_minute / 60.0);
    EXPECT_EQ(bench.heard().scans.size(), bench.sent().size());
    expect_scans_true(bench, 2 * kMs);
    const LrfGeometry& geometry = bench.session().geometry();
    EXPECT_EQ(geometry.beams, model.beams());
    EXPECT_NEAR(geometry.start_angle_rad, model.angle_rad(0), 3e-7);
    EXPECT_EQ(geometry.start_angle_rad, static_cast<double>(static_cast<float>(geometry.start_angle_rad)));
    EXPECT_EQ(bench.heard().scans[0].stamp_ns % 1000, 0);
    EXPECT_EQ(geometry.period_ns, model.turn_ns());
    EXPECT_NEAR(static_cast<double>(bench.heard().scans[0].beam_period_ns * (model.beams() - 1)),
                static_cast<double>(model.beam_list().back().time_ns - model.beam_list().front().time_ns), 2000.0);
    EXPECT_EQ(bench.session().counters().rejected, 0U);
    EXPECT_EQ(bench.session().counters().scans, bench.sent().size());
  }
}

// What a line takes for each byte can be told from the device's clock alone, which is asked for its time.
TEST(ScipSession, TakesTheDelayOfTheLineOffTheStamps) {
  for (const char* const model : {"utm-30lx", "urg-04lx"}) {
    for (const std::int64_t delay_ns : {0 * kMs, 2 * kMs, 8 * kMs}) {
      SCOPED_TRACE(std::string(model) + ", ms: " + std::to_string(delay_ns / kMs));
      Bench bench{model};
      bench.line_delay_ns = delay_ns;
      bench.reset();
      bench.run(3 * kSecond);
      EXPECT_GT(bench.heard().scans.size(), 20U);
      expect_scans_true(bench, 2 * kMs);
    }
  }
}

TEST(ScipSession, StreamsOfADeviceThatDoesNotTellItsTime) {
  for (const char* const answer : {"", "TM\n0Ee\n\n", "TM1\n00P\n\n", "TM1\n00P\n0000Z\n\n"}) {
    Bench bench;
    bench.on_the_way = [&](std::string& bytes) { bytes = bytes.starts_with("TM") ? answer : bytes; };
    bench.reset();
    bench.run(3 * kSecond);
    EXPECT_TRUE(bench.session().ready());
    EXPECT_EQ(bench.heard().count(LrfEventType::kUnanswered), 0);
    expect_scans_true(bench, 2 * kMs);
  }
}

TEST(ScipSession, HearsALogAtItsRecordedPace) {
  constexpr int kScans = 40;
  ScanLog log;
  for (int i = 0; i < kScans; ++i) {
    log.scans.push_back({.stamp_ns = 100 * kSecond + i * 100 * kMs + (i % 3) * 20 * kMs,
                         .start_angle_rad = -1.0,
                         .angle_step_rad = 0.01,
                         .ranges_m = std::vector<float>(201, 1.0F + 0.1F * static_cast<float>(i))});
  }
  const std::vector<LogScan> recorded = log.scans;
  Bench bench("utm-30lx", std::make_unique<LogSource>(test::period_ns_of("utm-30lx"), std::move(log), 2.0), {}, {});
  bench.reset();
  bench.run(3 * kSecond);
  const std::vector<test::HeardScan>& heard = bench.heard().scans;
  ASSERT_GE(heard.size(), recorded.size());
  for (std::size_t i = 0; i < recorded.size(); ++i) {
    const double wanted_ns = static_cast<double>(recorded[i].stamp_ns - recorded[0].stamp_ns) / 2.0;
    EXPECT_NEAR(static_cast<double>(heard[i].stamp_ns - heard[0].stamp_ns), wanted_ns, 2.0 * kMs) << i;
    EXPECT_NEAR(heard[i].ranges_m[540], recorded[i].ranges_m[100], 0.001) << "straight ahead";
  }
}

TEST(ScipSession, ComesToTheStreamFromEveryState) {
  for (const char* const before : {"", "MD0000108001000\n", "MS0000108001005\n", "ME0000108001000\n", "TM0\n", "BM\n",
                                   "MD0000", "TM0\nTM1\n", "RS\n", "SS115200\n", "GD0000108001\n", "\xFF\x00\r\r\n"}) {
    for (const char* const model : {"utm-30lx", "urg-04lx"}) {
      SCOPED_TRACE(std::string(model) + " after " + before);
      Bench bench{model};
      bench.say("SCIP2.0\n");
      bench.say(before);
      bench.run(60 * kMs);
      bench.reset();
      bench.run(800 * kMs);
      EXPECT_TRUE(bench.session().ready());
      EXPECT_GE(bench.heard().scans.size(), 4U);
      EXPECT_EQ(bench.heard().count(LrfEventType::kLost), 0);
    }
  }
}

TEST(ScipSession, AsksForWhatTheParametersSay) {
  LrfParams params;
  params.cluster = 3;
  params.skip = 1;
  params.reading = LrfReading::kShortRange;
  Bench bench{"utm-30lx", {}, params};
  bench.reset();
  bench.run(2 * kSecond);
  EXPECT_THAT(bench.written(), ::testing::HasSubstr("MS0000108003100\n"));
  ASSERT_GT(bench.heard().scans.size(), 30U);
  EXPECT_LT(bench.heard().scans.size(), 41U);
  const test::HeardScan& scan = bench.heard().scans.back();
  EXPECT_EQ(scan.ranges_m.size(), 361U);
  EXPECT_NEAR(scan.angle_step_rad, 3 * 0.25 * std::numbers::pi / 180, 1e-7);
  EXPECT_NEAR(scan.start_angle_rad, (-135 + 0.25) * std::numbers::pi / 180, 1e-6);
}

TEST(ScipSession, DropsIntensities) {
  LrfParams params;
  params.reading = LrfReading::kRangeIntensity;
  Bench bench{"urg-04lx", {}, params};
  bench.reset();
  bench.run(3 * kSecond);
  EXPECT_GT(bench.heard().scans.size(), 25U);
  expect_scans_true(bench, 2 * kMs);
}

// The emulated laser has two echoes where a beam grazes an edge: of the edge, and of what is behind it.
TEST(ScipSession, HearsWhatIsBehindTheFirstEcho) {
  const auto ranges_m = [](LrfReading reading) {
    LrfParams params;
    params.reading = reading;
    Bench bench{"utm-30lx-ew", {}, params};
    bench.reset();
    bench.run(2 * kSecond);
    EXPECT_EQ(bench.session().counters().rejected, 0U);
    EXPECT_EQ(bench.heard().scans.size(), bench.sent().size());
    return bench.heard().scans.back().ranges_m;
  };
  const std::vector<float> first_m = ranges_m(LrfReading::kRange);
  const std::vector<float> last_m = ranges_m(LrfReading::kLastEcho);
  ASSERT_EQ(first_m.size(), 1081U);
  ASSERT_EQ(last_m.size(), first_m.size());
  EXPECT_EQ(ranges_m(LrfReading::kStrongestEcho), first_m) << "both are as strong";
  int behind = 0;
  for (std::size_t i = 0; i < first_m.size(); ++i) {
    EXPECT_GE(last_m[i], first_m[i]) << "beam " << i;
    behind += last_m[i] > first_m[i] + 0.19F ? 1 : 0;
  }
  EXPECT_GE(behind, 1);
  EXPECT_LE(behind, 8);
}

// A laser that does not know the command says so.
TEST(ScipSession, ALaserOfOneEchoRefusesToTellSeveral) {
  LrfParams params;
  params.reading = LrfReading::kLastEcho;
  Bench bench{"utm-30lx", {}, params};
  bench.reset();
  bench.run(3 * kSecond);
  EXPECT_FALSE(bench.session().ready());
  EXPECT_TRUE(bench.heard().scans.empty());
  EXPECT_GT(bench.session().counters().device_errors, 0U);
}

TEST(ScipSession, SetsTheLineRateThatIsWished) {
  LrfParams params;
  params.baud = 115200;
  Bench bench{"utm-30lx", {}, params};
  bench.reset();
  bench.run(2 * kSecond);
  EXPECT_TRUE(bench.session().ready());
  EXPECT_EQ(bench.session().line_baud(), 115200);
}

// Of a URG on RS-232, a scan takes longer than ten turns at its own rate, or seven with intensities at 57600 baud.
TEST(ScipSession, HearsEveryScanThatASlowLineCarries) {
  struct Slow {
    int baud;
    LrfReading reading;
    std::int64_t scan_ns;
  };
  for (const Slow& slow :
       {Slow{19200, LrfReading::kRange, 1113 * kMs}, Slow{57600, LrfReading::kRangeIntensity, 737 * kMs}}) {
    SCOPED_TRACE(slow.baud);
    LrfParams params;
    params.baud = slow.baud;
    params.reading = slow.reading;
    Bench bench{"urg-04lx", {.faults = {}, .rs232_baud = slow.baud}, params};
    bench.reset();
    bench.run(15 * kSecond);
    EXPECT_TRUE(bench.session().ready());
    EXPECT_EQ(bench.session().counters().restarts, 0U);
    EXPECT_EQ(bench.heard().count(LrfEventType::kLost), 0);
    EXPECT_NEAR(static_cast<double>(bench.session().geometry().period_ns), static_cast<double>(slow.scan_ns),
                2.0 * kMs);
    // It measures the next scan as soon as the line is free, at most a turn after the one before has left.
    EXPECT_GE(static_cast<std::int64_t>(bench.heard().scans.size()), 14 * kSecond / (slow.scan_ns + 100 * kMs) - 1);
    EXPECT_EQ(bench.heard().scans.size(), bench.sent().size());
    expect_scans_true(bench, 3 * kMs);
  }
}

TEST(ScipSession, HuntsForTheRateOfASilentDevice) {
  LrfParams params;
  params.baud = 115200;
  const auto session = make_lrf_session(params, 2048);
  test::Heard heard;
  session->reset(0);
  std::vector<int> rates;
  for (std::int64_t now_ns = 0; now_ns < 4 * kSecond; now_ns += kMs) {
    if (rates.empty() || rates.back() != session->line_baud()) {
      rates.push_back(session->line_baud());
    }
    static_cast<void>(session->transmit());
    session->tick(now_ns, heard);
  }
  EXPECT_THAT(rates, ::testing::IsSupersetOf({115200, 19200, 57600, 250000, 500000, 750000}));
  EXPECT_EQ(heard.count(LrfEventType::kLost), 1) << "silence is told once";
}

TEST(ScipSession, RefusesADeviceWithMoreBeamsThanThereIsRoomFor) {
  const ScipModel& model = *find_scip_model("utm-30lx");
  WorldSource source(model.turn_ns(), test::small_drive());
  ScipDevice device(model, source, {}, 0);
  const auto session = make_lrf_session({}, 1080);
  test::Heard heard;
  session->reset(0);
  for (std::int64_t now_ns = 0; now_ns < kSecond; now_ns += kMs) {
    const auto request = session->transmit();
    device.receive({reinterpret_cast<const char*>(request.data()), request.size()}, now_ns);
    for (const SentBytes& sent : device.take_output()) {
      session->receive(std::as_bytes(std::span(sent.bytes.data(), sent.bytes.size())), now_ns, heard);
    }
    session->tick(now_ns, heard);
  }
  EXPECT_FALSE(session->ready());
  ASSERT_EQ(heard.events.size(), 1U);
  EXPECT_EQ(heard.events[0].reason, Errc::kTooManyBeams);
}

class ScipSessionFault : public ::testing::TestWithParam<test::FaultCase> {};

// Two seconds in, a fault; in the end the stream runs again, and no scan that was heard is wrong.
TEST_P(ScipSessionFault, IsSurvived) {
  const test::FaultCase& fault_case = GetParam();
  Bench bench{"utm-30lx", {.faults = {parse_fault(fault_case.fault)}}};
  bench.reset();
  bench.run(8 * kSecond);
  EXPECT_TRUE(bench.session().ready());
  const std::int64_t first_ns = bench.heard().scans.front().stamp_ns;
  const int lost = static_cast<int>((bench.now_ns() - first_ns) / bench.model().turn_ns()) -
                   static_cast<int>(bench.heard().scans.size());
  EXPECT_GE(lost, fault_case.scans_lost_min);
  EXPECT_LE(lost, fault_case.scans_lost_max);
  EXPECT_LT(bench.now_ns() - bench.heard().scans.back().arrival_ns, 30 * kMs);
  expect_scans_true(bench, 3 * kMs);
}

INSTANTIATE_TEST_SUITE_P(
    Scip, ScipSessionFault,
    ::testing::Values(test::FaultCase{"silence@2:1", 70, 38}, test::FaultCase{"garbage@2:1", 70, 38},
                      test::FaultCase{"truncate@2:0.2", 10, 7}, test::FaultCase{"wrong-sum@2:0.2", 10, 7},
                      test::FaultCase{"wrong-sum@2:1", 70, 38}, test::FaultCase{"reboot@2", 50, 11},
                      test::FaultCase{"beams@2:0.2", 10, 7}, test::FaultCase{"one-byte@2:1", 2, 0},
                      test::FaultCase{"drift=1000@0", 2, 0}, test::FaultCase{"drift=-500@2", 2, 0}),
    test::fault_name);

TEST(ScipSession, CountsScansThatAreTheSame) {
  Bench bench{"utm-30lx", {.faults = {parse_fault("stuck@1:1")}}};
  bench.reset();
  bench.run(1900 * kMs);
  EXPECT_GE(bench.session().counters().identical_run, 20U);
  bench.run(kSecond);
  EXPECT_EQ(bench.session().counters().identical_run, 0U);
  EXPECT_NEAR(static_cast<double>(bench.session().counters().identical), 40.0, 2.0);
}

TEST(ScipSession, TellsOfALostStreamOnce) {
  Bench bench{"utm-30lx", {.faults = {parse_fault("silence@1")}}};
  bench.reset();
  bench.run(1200 * kMs);
  EXPECT_EQ(bench.heard().count(LrfEventType::kLost), 0);
  bench.run(600 * kMs);
  EXPECT_EQ(bench.heard().count(LrfEventType::kLost), 1);
  bench.run(5 * kSecond);
  EXPECT_LE(bench.heard().count(LrfEventType::kLost), 2);
}

TEST(ScipSession, ResetsADeviceThatSaysItIsBroken) {
  Bench bench;
  bench.reset();
  bench.run(kSecond);
  const std::string status = std::string("MD0000108001000\n75") + scip::checksum("75") + "\n\n";
  bench.session().receive(std::as_bytes(std::span(status.data(), status.size())), bench.now_ns(),
                          const_cast<test::Heard&>(bench.heard()));
  EXPECT_FALSE(bench.session().ready());
  ASSERT_EQ(bench.heard().count(LrfEventType::kDeviceError), 1);
  EXPECT_EQ(bench.heard().events.back().device_status, scip::status("75"));
  bench.run(kSecond);
  EXPECT_THAT(bench.written(), ::testing::HasSubstr("RS\n"));
  EXPECT_TRUE(bench.session().ready());
  EXPECT_EQ(bench.session().counters().device_errors, 1U);
  EXPECT_EQ(bench.session().counters().restarts, 1U);
}

// A counter that runs 1000 ppm fast and wraps, bytes up to 5 ms late: after 10 s, every stamp is within 1 ms of the
// truth.
TEST(ScipSession, StampsAreRightInSpiteOfDriftJitterAndWrap) {
  Bench bench{"utm-30lx", {.faults = {parse_fault("drift=1000@0")}, .counter_start_ms = (1 << 24) - 12'000}};
  Rng rng(9);
  std::int64_t awake_ns = 0;
  bench.on_the_way = [&](std::string& bytes) {
    awake_ns = bytes.size() > 1000 ? bench.now_ns() + static_cast<std::int64_t>(rng.uniform(0.0, 5e6)) : awake_ns;
  };
  bench.reset();
  while (bench.heard().scans.size() < 1000) {
    bench.host_asleep = bench.now_ns() < awake_ns;
    bench.run(kMs / 4);
  }
  EXPECT_EQ(bench.session().counters().rejected, 0U);
  std::size_t next = 0;
  for (std::size_t i = 400; i < 1000; ++i) {
    const std::int64_t stamp_ns = bench.heard().scans[i].stamp_ns;
    while (bench.sent()[next].first_beam_ns < stamp_ns - 12 * kMs) {
      ++next;
    }
    ASSERT_LT(std::abs(stamp_ns - bench.sent()[next].first_beam_ns), kMs) << "scan " << i;
  }
}

TEST(ScipSession, AHostThatSleptKeepsTheStampsRight) {
  Bench bench;
  bench.reset();
  bench.run(4 * kSecond);
  bench.host_asleep = true;
  bench.run(400 * kMs);
  bench.host_asleep = false;
  bench.run(kSecond);
  EXPECT_EQ(bench.heard().scans.size(), bench.sent().size());
  expect_scans_true(bench, 2 * kMs);
}

}  // namespace
}  // namespace odoless
