// What the bring-up of a SICK asks of the laser, and what it makes of each answer.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <string_view>

#include "drivers/lrf/sick/sick_session.hpp"
#include "drivers/lrf/sick/telegram.hpp"
#include "tests/drivers/lrf/answered_line.hpp"
#include "tools/emulate/sick_device.hpp"

namespace odoless {
namespace {

using test::AnsweredLine;
using test::kMs;
using test::kSecond;

const std::string kSickStop = "\x20\x25";
const std::string kSickStart = "\x20\x24";
const std::string kSickInstall("\x20\x00SICK_LMS", 10);
constexpr std::size_t kSickConfigurationBytes = 34;
constexpr std::size_t kSickMode = 5;  ///< bytes of the configuration
constexpr std::size_t kSickUnit = 6;

LrfParams sick_line_params(int baud, SickUnit unit = SickUnit::kCm) {
  LrfParams params;
  params.driver = LrfDriver::kSick;
  params.baud = baud;
  params.sick_unit = unit;  // cm: the emulated laser's own, so that nothing is to be written
  return params;
}

std::string sick_asked(std::string_view payload) {
  const sick::Request made(std::as_bytes(std::span(payload.data(), payload.size())));
  return {reinterpret_cast<const char*>(made.bytes().data()), made.bytes().size()};
}

/// What the laser answers. @param status  Of the laser; 0x10: nothing is wrong.
std::string sick_answer(const std::string& payload, char status = '\x10') {
  std::string bytes("\x02\x80", 2);
  bytes += static_cast<char>(payload.size() + 1);
  bytes += '\0';
  bytes += payload + status;
  const std::uint16_t sum = sick::checksum(std::as_bytes(std::span(bytes.data(), bytes.size())));
  bytes += static_cast<char>(sum & 0xFFU);
  bytes += static_cast<char>(sum >> 8U);
  return bytes;
}

/// Command and data of a request.
std::string sick_payload(const std::string& request) { return request.substr(4, request.size() - 6); }

/// A configuration in which every byte is another.
std::string sick_configuration(char mode, char unit) {
  std::string configuration;
  for (std::size_t i = 0; i < kSickConfigurationBytes; ++i) {
    configuration += static_cast<char>(40 + i);
  }
  configuration[kSickMode] = mode;
  configuration[kSickUnit] = unit;
  return configuration;
}

/// Answers the requests with such a command and data in the laser's stead, `times` times.
void answer_sick(AnsweredLine& line, const std::string& beginning, const std::string& answer, int times = 1000) {
  constexpr std::size_t kHeaderBytes = 4;
  line.answer_instead(beginning, answer, times, kHeaderBytes);
}

TEST(SickBringUp, SwitchesALaserFromAnyRateToTheWishedOne) {
  const std::pair<int, const char*> rates[] = {
      {9600, "\x20\x42"}, {19200, "\x20\x41"}, {38400, "\x20\x40"}, {500000, "\x20\x48"}};
  for (const auto& [before_baud, before] : rates) {
    for (const auto& [wished_baud, command] : rates) {
      SCOPED_TRACE(std::to_string(before_baud) + " to " + std::to_string(wished_baud));
      AnsweredLine line("lms291", sick_line_params(wished_baud));
      line.device_as<SickDevice>().receive(sick_asked(before), line.now_ns());
      line.reset();
      line.run(5 * kSecond);
      ASSERT_TRUE(line.session().ready());
      EXPECT_EQ(line.session().line_baud(), wished_baud);
      EXPECT_EQ(line.asked(sick_asked(command)), before_baud == wished_baud ? 0 : 1);
      EXPECT_EQ(line.asked(sick_asked(kSickStart)), 1);
      EXPECT_EQ(line.heard().count(LrfEventType::kReady), 1);
      EXPECT_EQ(line.heard().count(LrfEventType::kDeviceError), 0);
      EXPECT_GE(line.heard().scans.size(), 1U);
    }
  }
}

TEST(SickBringUp, ALaserThatRefusesTheRateIsUsedAtTheOneThatItHas) {
  AnsweredLine line("lms291", sick_line_params(500000));
  answer_sick(line, "\x20\x48", sick_answer("\xA0\x01"));
  line.reset();
  line.run(6 * kSecond);
  ASSERT_TRUE(line.session().ready());
  EXPECT_EQ(line.session().line_baud(), 9600);
  EXPECT_EQ(line.asked(sick_asked("\x20\x48")), 1) << "and not again";
  EXPECT_GE(line.heard().scans.size(), 3U);
  EXPECT_EQ(line.heard().count(LrfEventType::kDeviceError), 0);
}

TEST(SickBringUp, WithoutAWishTheRateThatIsFoundStays) {
  AnsweredLine line("lms291", sick_line_params(0));
  line.device_as<SickDevice>().receive(sick_asked("\x20\x40"), line.now_ns());
  line.reset();
  line.run(5 * kSecond);
  ASSERT_TRUE(line.session().ready());
  EXPECT_EQ(line.session().line_baud(), 38400);
}

TEST(SickBringUp, WritesUnitAndModeAndLeavesTheRestOfTheConfiguration) {
  struct Case {
    SickUnit wished;
    char mode;
    char unit;
  };
  for (const Case& wished : {Case{SickUnit::kMm, 6, 1}, Case{SickUnit::kCm, 0, 0}}) {
    for (const auto& [mode, unit] : {std::pair<char, char>(6, 1), {0, 0}, {1, 1}, {1, 0}, {6, 0}}) {
      SCOPED_TRACE(std::to_string(wished.mode) + " where it has " + std::to_string(mode) + " and " +
                   std::to_string(unit));
      AnsweredLine line("lms291", sick_line_params(9600, wished.wished));
      answer_sick(line, "\x74", sick_answer("\xF4" + sick_configuration(mode, unit)));
      line.reset();
      line.run(4 * kSecond);
      ASSERT_TRUE(line.session().ready());
      EXPECT_EQ(line.heard().count(LrfEventType::kDeviceError), 0);
      const std::string written = sick_asked("\x77" + sick_configuration(wished.mode, wished.unit));
      const bool differs = mode != wished.mode || unit != wished.unit;
      EXPECT_EQ(line.asked(written), differs ? 1 : 0);
      EXPECT_EQ(line.asked(sick_asked(kSickInstall)), differs ? 1 : 0);
      EXPECT_EQ(line.device_as<SickDevice>().writes(), differs ? 1 : 0) << "its memory wears";
    }
  }
}

TEST(SickBringUp, ARefusalIsToldWithItsCodeAndTheLaserIsResetAndTriedAgain) {
  struct Case {
    const char* what;
    std::string beginning;
    std::string answer;
    int code;
  };
  for (const Case& refusal :
       {Case{"its installation mode", kSickInstall, sick_answer("\xA0\x01"), 1},
        Case{"its configuration", "\x77", sick_answer("\xF7\x02" + sick_configuration(0, 0)), 2},
        Case{"the variant", "\x3B", sick_answer(std::string("\xBB\x00\xB4\x00\x32\x00", 6)), 0},
        Case{"the stream", kSickStart, sick_answer("\xA0\x02"), 2},
        Case{"all, for it is broken", "\x31", sick_answer("\xB1" + std::string(151, '\0'), '\x14'), 0x14}}) {
    SCOPED_TRACE(refusal.what);
    AnsweredLine line("lms291", sick_line_params(500000, SickUnit::kMm));
    answer_sick(line, refusal.beginning, refusal.answer, 1);
    line.reset();
    line.run(1500 * kMs);
    EXPECT_FALSE(line.session().ready());
    ASSERT_EQ(line.heard().count(LrfEventType::kDeviceError), 1);
    EXPECT_EQ(line.heard().events.back().device_status, refusal.code);
    EXPECT_EQ(line.session().counters().device_errors, 1U);
    line.run(14 * kSecond);
    EXPECT_EQ(line.asked(sick_asked("\x10")), 1);
    EXPECT_TRUE(line.session().ready());
    EXPECT_EQ(line.session().line_baud(), 500000);
    EXPECT_EQ(line.heard().count(LrfEventType::kDeviceError), 1);
  }
}

TEST(SickBringUp, ASlightTroubleIsNoReasonNotToStream) {
  AnsweredLine line("lms291", sick_line_params(500000));
  answer_sick(line, "\x31", sick_answer("\xB1" + std::string(151, '\0'), '\x13'));
  line.reset();
  line.run(3 * kSecond);
  EXPECT_TRUE(line.session().ready());
}

TEST(SickBringUp, WhatIsNotUnderstoodIsAskedAgainThreeTimesEach) {
  AnsweredLine line("lms291", sick_line_params(9600));
  line.in_its_stead = [&](const std::string& request) -> std::optional<std::string> {
    const bool is_first_step = sick_payload(request) == kSickStop;
    return is_first_step || line.asked(request) > 3 ? std::nullopt : std::optional<std::string>("\x15");
  };
  line.reset();
  line.run(3 * kSecond);
  EXPECT_TRUE(line.session().ready());
  EXPECT_EQ(line.asked(sick_asked(kSickStop)), 1) << "it is not begun anew";
  EXPECT_EQ(line.asked(sick_asked("\x31")), 4);
  EXPECT_EQ(line.asked(sick_asked("\x74")), 4);
  EXPECT_EQ(line.asked(sick_asked(kSickStart)), 4);
}

TEST(SickBringUp, ALaserThatUnderstandsNothingIsNotFloodedWithRequests) {
  AnsweredLine line("lms291", sick_line_params(9600));
  answer_sick(line, "\x31", "\x15");
  line.reset();
  line.run(kSecond);
  EXPECT_EQ(line.asked(sick_asked("\x31")), 4);
  EXPECT_FALSE(line.session().ready());
}

TEST(SickBringUp, ALaserThatAnswersTheFirstStepAloneIsToldOfOnce) {
  AnsweredLine line("lms291", sick_line_params(9600));
  answer_sick(line, "\x31", "");
  line.reset();
  line.run(12 * kSecond);
  EXPECT_FALSE(line.session().ready());
  EXPECT_GE(line.asked(sick_asked("\x31")), 5) << "it is asked on";
  ASSERT_EQ(line.heard().events.size(), 1U);
  EXPECT_EQ(line.heard().events[0].type, LrfEventType::kUnanswered);
  line.reset();  // its line was opened anew
  line.run(12 * kSecond);
  EXPECT_EQ(line.heard().events.size(), 2U) << "it is told again";
}

/// A laser that hears and streams on: a scan comes instead of each of the first answers to the first step.
AnsweredLine& with_scans_instead(AnsweredLine& line, int scans) {
  answer_sick(line, kSickStop, sick_answer("\xB0" + std::string(20, '\x01')), scans);
  return line;
}

// At 9600 baud, a scan that is on its way holds an answer up for 0.8 s, four times the usual patience.
TEST(SickBringUp, AnAnswerIsWaitedForWhereAScanComesFirst) {
  AnsweredLine line("lms291", sick_line_params(38400));
  with_scans_instead(line, 100);
  line.reset();
  line.run(950 * kMs);
  EXPECT_EQ(line.requests().size(), 1U);
  line.say(sick_answer(std::string("\xA0\x00", 2)));
  line.run(10 * kMs);
  EXPECT_EQ(line.asked(sick_asked("\x31")), 1);
  EXPECT_EQ(line.session().line_baud(), 38400);
}

TEST(SickBringUp, ALaserThatStreamsOnIsStoppedSixTimesBeforeAnotherRateIsTried) {
  AnsweredLine line("lms291", sick_line_params(38400));
  with_scans_instead(line, 100);
  line.reset();
  line.run(5900 * kMs);
  EXPECT_EQ(line.asked(sick_asked(kSickStop)), 6);
  EXPECT_EQ(line.session().line_baud(), 38400);
  EXPECT_TRUE(line.heard().events.empty());
  line.run(300 * kMs);
  EXPECT_EQ(line.session().line_baud(), 9600);
  EXPECT_EQ(line.heard().count(LrfEventType::kLost), 1);
  line.run(5500 * kMs);
  EXPECT_EQ(line.session().line_baud(), 9600) << "it is as patient there";
  line.run(500 * kMs);
  EXPECT_EQ(line.session().line_baud(), 19200);
}

TEST(SickBringUp, ARateWhereNothingIsHeardAnyMoreIsLeftAtOnce) {
  AnsweredLine line("lms291", sick_line_params(38400));  // it is at 9600
  with_scans_instead(line, 1);
  line.reset();
  line.run(1150 * kMs);
  EXPECT_EQ(line.session().line_baud(), 38400);
  line.run(150 * kMs);
  EXPECT_EQ(line.session().line_baud(), 9600);
}

TEST(SickBringUp, EachTimeTheLineIsOpenedAndAfterEachAnswerItIsAsPatient) {
  AnsweredLine line("lms291", sick_line_params(9600));
  for (int i = 0; i < 3; ++i) {
    with_scans_instead(line, 4);
    line.reset();
    line.run(5 * kSecond);
    EXPECT_TRUE(line.session().ready());
  }
  int round = 0;
  line.in_its_stead = [&](const std::string& request) -> std::optional<std::string> {
    const bool is_first = sick_payload(request) == kSickStop;
    round += is_first ? 1 : 0;
    const bool is_heard = round % 4 == 0 || round > 12;
    return is_first && !is_heard     ? std::optional(sick_answer("\xB0" + std::string(20, '\x01')))
           : !is_first && round <= 8 ? std::optional(std::string())
                                     : std::nullopt;
  };
  line.reset();
  line.run(15 * kSecond);
  EXPECT_TRUE(line.session().ready());
  EXPECT_EQ(line.heard().count(LrfEventType::kLost), 0);
}

TEST(SickBringUp, ALineThatIsOpenedAnewHasAllItsPatienceAgain) {
  AnsweredLine line("lms291", sick_line_params(38400));
  with_scans_instead(line, 100);
  line.reset();
  line.run(4500 * kMs);
  line.reset();
  line.run(5900 * kMs);
  EXPECT_EQ(line.session().line_baud(), 38400);
  EXPECT_TRUE(line.heard().events.empty());
}

TEST(SickBringUp, WhatComesLateInThePauseChangesNothing) {
  AnsweredLine line("lms291", sick_line_params(9600));
  answer_sick(line, kSickStart, sick_answer("\xA0\x02"), 1);
  line.reset();
  line.run(kSecond);
  ASSERT_EQ(line.heard().events.size(), 1U);
  const std::size_t requests = line.requests().size();
  line.say(sick_answer("\xA0\x01"));
  line.say(sick_answer(std::string("\xA0\x00", 2)));
  line.say("\x15");
  line.run(10 * kMs);
  EXPECT_EQ(line.heard().events.size(), 1U);
  EXPECT_EQ(line.requests().size(), requests);
}

TEST(SickBringUp, AnswersThatAreTooShortOrUnknownAreRefusedWithTheReason) {
  std::string unknown(151, '\0');
  unknown[106] = '\xB4';  // 180 degrees in steps of 0.33
  unknown[108] = '\x21';
  struct Case {
    std::string beginning;
    std::string answer;
    Errc reason;
  };
  for (const Case& refused : {Case{"\x31", "\xB1" + std::string(109, '\0'), Errc::kFrameTruncated},
                              Case{"\x31", "\xB1" + unknown, Errc::kFrameMalformed},
                              Case{"\x74", "\xF4" + std::string(6, '\0'), Errc::kFrameTruncated}}) {
    AnsweredLine line("lms291", sick_line_params(0));
    line.session_as<SickSession>().only_ask();
    answer_sick(line, refused.beginning, sick_answer(refused.answer), 1);
    line.reset();
    line.run(kSecond);
    EXPECT_FALSE(line.session().ready());
    ASSERT_EQ(line.heard().events.size(), 1U);
    EXPECT_EQ(line.heard().events[0].type, LrfEventType::kRejected);
    EXPECT_EQ(line.heard().events[0].reason, refused.reason);
    line.run(3 * kSecond);
    EXPECT_EQ(line.heard().count(LrfEventType::kReady), 1) << "it is asked again after a pause";
  }
}

/// A status that tells 180 degrees in steps of 0.5, and nothing else that makes sense.
std::string sick_status(std::size_t bytes) {
  std::string status(bytes, '\x55');
  status.replace(106, 4, std::string("\xB4\x00\x32\x00", 4));
  return "\xB1" + status;
}

TEST(SickBringUp, OnlyAskedItTellsWhatTheLaserIsAndChangesNothing) {
  for (const auto& [mode, unit] : {std::pair<char, char>(6, 1), {0, 0}, {0, 1}, {6, 0}}) {
    LrfParams params = sick_line_params(0, SickUnit::kMm);
    params.sick_variant = SickVariant::k100By1;
    AnsweredLine line("lms291", params);
    line.session_as<SickSession>().only_ask();
    line.in_its_stead = [mode = mode, unit = unit](const std::string& request) -> std::optional<std::string> {
      return sick_payload(request) == "\x31" ? std::optional(sick_answer(sick_status(110)))
             : sick_payload(request) == "\x74"
                 ? std::optional(sick_answer("\xF4" + sick_configuration(mode, unit).substr(0, 7)))
                 : std::nullopt;
    };
    line.reset();
    line.run(500 * kMs);
    ASSERT_TRUE(line.session().ready());
    const sick::Found& found = line.session_as<SickSession>().found();
    EXPECT_EQ(found.variant, SickVariant::k180ByHalf);
    EXPECT_EQ(found.unit, unit == 1 ? SickUnit::kMm : SickUnit::kCm);
    EXPECT_EQ(found.is_usual_mode, mode == 6 * unit);
    EXPECT_EQ(line.session().geometry().beams, 361);
    EXPECT_THAT(line.requests(), ::testing::ElementsAre(sick_asked(kSickStop), sick_asked("\x31"), sick_asked("\x74")));
  }
}

TEST(SickBringUp, OnlyAskedALaserThatIsBrokenIsNotReset) {
  AnsweredLine line("lms291", sick_line_params(0));
  line.session_as<SickSession>().only_ask();
  answer_sick(line, "\x31", sick_answer("\xB1" + std::string(151, '\0'), '\x14'));
  line.reset();
  line.run(4 * kSecond);
  EXPECT_GE(line.heard().count(LrfEventType::kDeviceError), 2);
  EXPECT_EQ(line.asked(sick_asked("\x10")), 0);
}

}  // namespace
}  // namespace odoless
