// What the bring-up of a Hokuyo asks of the laser, and what it makes of each answer.
#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string>

#include "drivers/lrf/scip/replies.hpp"
#include "tests/drivers/lrf/answered_line.hpp"
#include "tools/emulate/scip_device.hpp"
#include "tools/emulate/scip_text.hpp"

namespace odoless {
namespace {

using test::AnsweredLine;
using test::kMs;
using test::kSecond;

LrfParams scip_line_params(int baud = 0) {
  LrfParams params;
  params.baud = baud;
  return params;
}

std::string scip_rate_request(int baud) { return fmt::format("SS{:06d}\n", baud); }

TEST(ScipBringUp, SwitchesALaserFromAnyRateToTheWishedOne) {
  constexpr int kRates[] = {19200, 57600, 115200, 250000, 500000, 750000};
  for (const int before_baud : kRates) {
    for (const int wished_baud : kRates) {
      SCOPED_TRACE(fmt::format("{} to {}", before_baud, wished_baud));
      AnsweredLine line("urg-04lx", scip_line_params(wished_baud), {.faults = {}, .rs232_baud = before_baud});
      line.reset();
      line.run(5 * kSecond);
      ASSERT_TRUE(line.session().ready());
      EXPECT_EQ(line.session().line_baud(), wished_baud);
      EXPECT_EQ(line.asked(scip_rate_request(wished_baud)), before_baud == wished_baud ? 0 : 1);
      EXPECT_EQ(line.session().counters().device_errors, 0U);
      const auto switched = std::ranges::find(line.requests(), scip_rate_request(wished_baud));
      EXPECT_LE(std::count(switched, line.requests().end(), "\nQT\n"), 1) << "it is not searched for anew";
      EXPECT_GE(line.heard().scans.size(), 1U);
    }
  }
}

TEST(ScipBringUp, ALaserThatRefusesTheRateIsUsedAtTheOneThatItHas) {
  for (const char* const status : {"01", "02", "04"}) {
    AnsweredLine line("urg-04lx", scip_line_params(115200), {.faults = {}, .rs232_baud = 57600});
    line.answer_instead("SS", scip::answer("SS115200", status));
    line.reset();
    line.run(5 * kSecond);
    ASSERT_TRUE(line.session().ready());
    EXPECT_EQ(line.session().line_baud(), 57600);
    EXPECT_EQ(line.asked(scip_rate_request(115200)), 1) << "and not again";
    EXPECT_GE(line.heard().scans.size(), 3U);
  }
}

TEST(ScipBringUp, ALaserThatSaysThatItHasTheRateIsFollowedToIt) {
  AnsweredLine line("urg-04lx", scip_line_params(115200), {.faults = {}, .rs232_baud = 57600});
  line.in_its_stead = [&](const std::string& request) -> std::optional<std::string> {
    if (!request.starts_with("SS")) {
      return std::nullopt;
    }
    auto& device = line.device_as<ScipDevice>();
    device.receive(request, line.now_ns());
    static_cast<void>(device.take_output());
    return scip::answer("SS115200", "03");
  };
  line.reset();
  line.run(3 * kSecond);
  ASSERT_TRUE(line.session().ready());
  EXPECT_EQ(line.session().line_baud(), 115200);
  EXPECT_EQ(line.asked(scip_rate_request(115200)), 1);
}

TEST(ScipBringUp, AnAnswerToTheRateThatIsDamagedOrAnothersIsNoAnswer) {
  for (const std::string& answer : {std::string("SS115200\n00X\n\n"), scip::answer("QT", "02"), std::string()}) {
    AnsweredLine line("urg-04lx", scip_line_params(115200), {.faults = {}, .rs232_baud = 57600});
    line.answer_instead("SS", answer, 1);
    line.reset();
    line.run(4 * kSecond);
    ASSERT_TRUE(line.session().ready());
    EXPECT_EQ(line.session().line_baud(), 115200);
    EXPECT_EQ(line.asked(scip_rate_request(115200)), 2);
  }
}

TEST(ScipBringUp, LeavesTheTimeModeThatSomebodyLeftItIn) {
  for (const char* const model : {"urg-04lx", "utm-30lx"}) {
    AnsweredLine line(model, scip_line_params());
    for (const char* const before : {"SCIP2.0\n", "TM0\n"}) {
      line.device_as<ScipDevice>().receive(before, line.now_ns());
    }
    static_cast<void>(line.device_as<ScipDevice>().take_output());
    line.reset();
    line.run(kSecond);
    EXPECT_TRUE(line.session().ready()) << model;
    EXPECT_EQ(line.heard().events.size(), 1U) << "ready, and no complaint";
  }
}

// Each answer is followed by the next request: nothing waits for a time to be over but the line to be quiet.
TEST(ScipBringUp, AsksInOrderAndWithoutDelay) {
  AnsweredLine line("utm-30lx", scip_line_params());
  line.reset();
  line.run(150 * kMs);
  EXPECT_TRUE(line.session().ready());
  std::vector<std::string> requests = line.requests();
  requests.erase(std::unique(requests.begin(), requests.end()), requests.end());
  EXPECT_THAT(requests,
              ::testing::ElementsAre("\nQT\n", "QT\n", "PP\n", "TM0\n", "TM1\n", "TM2\n", "MD0000108001000\n"));
}

TEST(ScipBringUp, AsksForTheScansThatTheParametersSay) {
  LrfParams params = scip_line_params();
  for (const auto& [reading, request] : {std::pair(LrfReading::kRange, "MD0000108003200\n"),
                                         {LrfReading::kShortRange, "MS0000108003200\n"},
                                         {LrfReading::kRangeIntensity, "ME0000108003200\n"}}) {
    params.cluster = 3;
    params.skip = 2;
    params.reading = reading;
    AnsweredLine line("utm-30lx", params);
    line.reset();
    line.run(2 * kSecond);
    EXPECT_EQ(line.asked(request), 1);
    const LrfGeometry& geometry = line.session().geometry();
    EXPECT_EQ(geometry.beams, 361);
    EXPECT_EQ(geometry.period_ns, 75 * kMs) << "every third of 40 a second";
    EXPECT_NEAR(geometry.range_min_m, find_scip_model("utm-30lx")->range_min_mm * 1e-3, 1e-9);
    EXPECT_NEAR(geometry.range_max_m, find_scip_model("utm-30lx")->range_max_mm * 1e-3, 1e-9);
    EXPECT_NEAR(geometry.angle_step_rad, 0.75 * M_PI / 180.0, 1e-7);
    EXPECT_NEAR(geometry.start_angle_rad, (0.25 - 135.0) * M_PI / 180.0, 1e-6) << "the middle of the first three";
    EXPECT_NEAR(static_cast<double>(line.heard().scans.size()), 25.0, 2.0);
  }
}

TEST(ScipBringUp, AsksNothingBeforeTheLineIsQuietOrASecondIsOver) {
  for (const int noise_ms : {300, 980}) {
    AnsweredLine line("utm-30lx", scip_line_params());
    line.reset();
    for (int ms = 0; ms < noise_ms; ms += 20) {
      line.run(20 * kMs);
      line.say("0mP\n");
    }
    EXPECT_THAT(line.requests(), ::testing::ElementsAre("\nQT\n")) << noise_ms;
    line.run(80 * kMs);
    EXPECT_GE(line.requests().size(), 2U) << noise_ms;
  }
}

TEST(ScipBringUp, AUrgInScip1IsSwitchedAndAskedAgain) {
  AnsweredLine line("urg-04lx", scip_line_params());
  line.reset();
  line.run(kSecond);
  EXPECT_TRUE(line.session().ready());
  EXPECT_EQ(line.asked("SCIP2.0\n"), 1);
  EXPECT_EQ(line.asked("QT\n"), 2);
  EXPECT_EQ(line.asked("\nQT\n"), 1) << "it is not begun anew";
  EXPECT_EQ(line.heard().events.size(), 1U) << "ready, and no complaint";
}

TEST(ScipBringUp, ARefusedStreamIsToldWithItsStatusAndTheLaserIsResetAndTriedAgain) {
  AnsweredLine line("utm-30lx", scip_line_params());
  line.answer_instead("MD", scip::answer("MD0000108001000", "50"), 1);
  line.reset();
  line.run(150 * kMs);
  ASSERT_EQ(line.heard().events.size(), 1U);
  EXPECT_EQ(line.heard().events[0].type, LrfEventType::kDeviceError);
  EXPECT_EQ(line.heard().events[0].device_status, scip::status("50"));
  line.forget_requests();
  line.run(800 * kMs);
  EXPECT_TRUE(line.requests().empty()) << "it has a pause first";
  line.run(kSecond);
  ASSERT_FALSE(line.requests().empty());
  EXPECT_EQ(line.requests().front(), "RS\n");
  EXPECT_TRUE(line.session().ready());
  EXPECT_EQ(line.asked("RS\n"), 1);
  EXPECT_EQ(line.session().counters().device_errors, 1U);
}

TEST(ScipBringUp, DamagedAnswersAreAskedForAnewWithoutAComplaint) {
  for (const auto& [beginning, answer] : {std::pair("MD", "MD0000108001000\n00X\n\n"), {"QT", "QT\n00X\n\n"}}) {
    AnsweredLine line("utm-30lx", scip_line_params());
    line.answer_instead(beginning, answer, 1);
    line.reset();
    line.run(380 * kMs);
    EXPECT_TRUE(line.session().ready()) << beginning;
    EXPECT_EQ(line.heard().events.size(), 1U) << "ready";
  }
}

TEST(ScipBringUp, ParametersThatCannotBeReadAreToldAndAskedForAgain) {
  AnsweredLine line("utm-30lx", scip_line_params());
  line.answer_instead("PP", "PP\n" + scip::summed("00") + scip::key_line("DMIN", "20") + "\n", 1);
  line.reset();
  line.run(500 * kMs);
  ASSERT_EQ(line.heard().events.size(), 1U);
  EXPECT_EQ(line.heard().events[0].type, LrfEventType::kRejected);
  EXPECT_EQ(line.heard().events[0].reason, Errc::kFrameTruncated);
  line.run(1500 * kMs);
  EXPECT_TRUE(line.session().ready());
  EXPECT_EQ(line.asked("RS\n"), 0) << "it is not broken";
}

TEST(ScipBringUp, ALaserThatAnswersTheFirstStepAloneIsToldOfOnce) {
  AnsweredLine line("utm-30lx", scip_line_params());
  line.answer_instead("PP", "");
  line.reset();
  line.run(10 * kSecond);
  EXPECT_FALSE(line.session().ready());
  EXPECT_GE(line.asked("PP\n"), 10) << "it is asked on";
  ASSERT_EQ(line.heard().events.size(), 1U);
  EXPECT_EQ(line.heard().events[0].type, LrfEventType::kUnanswered);
}

TEST(ScipBringUp, ALaserThatTellsNoTimeIsAskedForItOnceInABringUp) {
  AnsweredLine line("utm-30lx", scip_line_params());
  line.answer_instead("TM0", "");
  for (int bring_ups = 1; bring_ups <= 2; ++bring_ups) {
    line.reset();
    line.run(kSecond);
    EXPECT_TRUE(line.session().ready());
    EXPECT_EQ(line.asked("TM0\n"), bring_ups);
  }
  EXPECT_EQ(line.heard().count(LrfEventType::kUnanswered), 0);
}

TEST(ScipBringUp, WhatALaserSaysWhileItStreamsEndsTheStreamByItsKind) {
  struct Case {
    const char* status;
    bool ends;
    bool is_reset;
    int told;
  };
  for (const Case& said : {Case{"00", false, false, 0}, Case{"98", false, false, 1}, Case{"10", true, false, 1},
                           Case{"0L", true, false, 1}, Case{"50", true, true, 1}, Case{"97", true, true, 1}}) {
    SCOPED_TRACE(said.status);
    AnsweredLine line("utm-30lx", scip_line_params());
    line.reset();
    line.run(kSecond);
    line.forget_requests();
    line.say(scip::answer("MD0000108001000", said.status));
    EXPECT_EQ(line.session().ready(), !said.ends);
    EXPECT_EQ(line.heard().count(LrfEventType::kDeviceError), said.told);
    line.run(kSecond);
    EXPECT_EQ(line.asked("RS\n"), said.is_reset ? 1 : 0);
    EXPECT_TRUE(line.session().ready());
  }
}

TEST(ScipBringUp, DamageInTheStreamIsCountedAndTold) {
  AnsweredLine line("utm-30lx", scip_line_params());
  line.reset();
  line.run(kSecond);
  line.say("MD0000108001000\n99X\n0000\n\n");
  EXPECT_EQ(line.session().counters().rejected, 1U);
  ASSERT_EQ(line.heard().count(LrfEventType::kRejected), 1);
  EXPECT_EQ(line.heard().events.back().reason, Errc::kWrongSum);
  line.say("MD0000108001000\n" + scip::summed("99") + "\n");
  EXPECT_EQ(line.session().counters().rejected, 2U);
  EXPECT_EQ(line.heard().count(LrfEventType::kRejected), 2);
  EXPECT_TRUE(line.session().ready());
}

// What a line takes for each byte can be told from the device's clock alone, which is asked for its time.
TEST(ScipBringUp, TakesTheDelayOfTheLineOffTheStamps) {
  for (const char* const model : {"utm-30lx", "urg-04lx"}) {
    test::Bench bench{model};
    bench.line_delay_ns = 8 * kMs;
    bench.reset();
    bench.run(3 * kSecond);
    ASSERT_GT(bench.heard().scans.size(), 20U);
    for (const test::HeardScan& scan : bench.heard().scans) {
      std::int64_t least_ns = kSecond;
      for (const SentScan& sent : bench.sent()) {
        least_ns = std::min<std::int64_t>(least_ns, std::abs(sent.first_beam_ns - scan.stamp_ns));
      }
      ASSERT_LT(least_ns, 2 * kMs) << model;
    }
  }
}

}  // namespace
}  // namespace odoless
