// What the bring-up of an RPLIDAR asks of the laser, and which scan it chooses by the answers.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <string_view>
#include <vector>

#include "drivers/lrf/rplidar/packet.hpp"
#include "tests/drivers/lrf/answered_line.hpp"
#include "tools/emulate/rplidar_device.hpp"

namespace odoless {
namespace {

using rplidar::Command;
using rplidar::Setting;
using test::AnsweredLine;
using test::kMs;
using test::kSecond;

LrfParams rplidar_line_params(RplidarScan scan = RplidarScan::kUsual) {
  LrfParams params;
  params.driver = LrfDriver::kRplidar;
  params.rplidar_scan = scan;
  return params;
}

std::string rplidar_asked(Command command, std::string_view payload = {}) {
  const rplidar::Request made(command, std::as_bytes(std::span(payload.data(), payload.size())));
  return {reinterpret_cast<const char*>(made.bytes().data()), made.bytes().size()};
}

std::string rplidar_number(int value) { return {static_cast<char>(value & 0xFF), static_cast<char>(value >> 8)}; }

/// Of the mode of that number.
std::string rplidar_express(int mode) {
  return rplidar_asked(Command::kExpress, static_cast<char>(mode) + std::string(4, '\0'));
}

std::string rplidar_question(Setting setting, int mode = 0) {
  return rplidar_asked(Command::kSetting,
                       rplidar_number(static_cast<int>(setting)) + std::string(2, '\0') + rplidar_number(mode));
}

/// @param mode  1: packets of that length follow.
std::string rplidar_answer(int type, const std::string& data, char mode = '\0') {
  std::string answer = "\xA5\x5A";
  answer += static_cast<char>(data.size());
  answer += std::string(2, '\0') + static_cast<char>(mode << 6) + static_cast<char>(type);
  return mode == 0 ? answer + data : answer;
}

std::string rplidar_value(Setting setting, const std::string& value) {
  return rplidar_answer(0x20, rplidar_number(static_cast<int>(setting)) + std::string(2, '\0') + value);
}

/// It streams by this request, the only one for a scan, and nothing was wrong.
void expect_streams_by(AnsweredLine& line, const std::string& request) {
  EXPECT_TRUE(line.session().ready());
  EXPECT_GE(line.heard().scans.size(), 3U);
  EXPECT_EQ(line.heard().events.size(), 1U) << "ready, and no complaint";
  EXPECT_EQ(line.asked(request), 1);
  const auto scans = std::ranges::count_if(line.requests(), [](const std::string& asked) {
    return asked.starts_with("\xA5\x20") || asked.starts_with("\xA5\x82");
  });
  EXPECT_EQ(scans, 1);
}

TEST(RplidarBringUp, StartsTheModeThatIsWishedForOrRecommended) {
  for (const RplidarModel& model : rplidar_models()) {
    for (const RplidarScan scan : {RplidarScan::kUsual, RplidarScan::kStandard, RplidarScan::kExpress}) {
      if (!model.knows_express() && scan == RplidarScan::kExpress) {
        continue;  // it has no such scan
      }
      SCOPED_TRACE(std::string(model.name) + " " + kRplidarScanNames[static_cast<std::size_t>(scan)]);
      AnsweredLine line(std::string(model.name), rplidar_line_params(scan));
      line.reset();
      line.run(3 * kSecond);
      const int usual = model.knows_configuration() ? static_cast<int>(model.usual_mode) : 0;
      const int express = model.knows_configuration() ? 1 : 0;
      const bool is_standard = scan == RplidarScan::kStandard || !model.knows_express();
      expect_streams_by(line, is_standard ? rplidar_asked(Command::kScan)
                                          : rplidar_express(scan == RplidarScan::kUsual ? usual : express));
      if (model.knows_configuration()) {
        const std::size_t mode = is_standard ? 0 : scan == RplidarScan::kUsual ? model.usual_mode : 1;
        EXPECT_NEAR(line.session().geometry().range_max_m, model.modes[mode].range_max_m, 0.01);
      }
    }
  }
}

TEST(RplidarBringUp, WhereThePacketsOfTheRecommendedModeAreUnknownTheStandardScanIsTaken) {
  AnsweredLine line("rplidar-a3", rplidar_line_params());
  line.answer_instead(rplidar_question(Setting::kModeAnswer, 3), rplidar_value(Setting::kModeAnswer, "\x99"));
  line.reset();
  line.run(2 * kSecond);
  expect_streams_by(line, rplidar_asked(Command::kScan));
}

TEST(RplidarBringUp, WhereThePacketsOfNoModeAreKnownThatIsToldAndTheLaserAskedAgain) {
  AnsweredLine line("rplidar-a3", rplidar_line_params(RplidarScan::kStandard));
  line.answer_instead(rplidar_question(Setting::kModeAnswer), rplidar_value(Setting::kModeAnswer, "\x99"), 1);
  line.reset();
  line.run(kSecond);
  ASSERT_EQ(line.heard().events.size(), 1U);
  EXPECT_EQ(line.heard().events[0].type, LrfEventType::kRejected);
  EXPECT_EQ(line.heard().events[0].reason, Errc::kFrameMalformed);
  line.run(2 * kSecond);
  EXPECT_TRUE(line.session().ready());
  EXPECT_EQ(line.asked(rplidar_asked(Command::kReset)), 0) << "it is not broken";
}

// What it doesn't tell, or what cannot be, is taken for that of an old one: the express scan by its old number, if it
// says what a sample takes.
TEST(RplidarBringUp, WithoutAListOfModesTheOldExpressScanIsTaken) {
  struct Case {
    const char* what;
    std::string question;
    std::string answer;
  };
  const std::string sample = rplidar_question(Setting::kModeSample, 3);
  for (const Case& told :
       {Case{"no answer", rplidar_asked(Command::kSetting, std::string(6, '\x7C')).substr(0, 3), ""},
        Case{"no usual mode", rplidar_question(Setting::kUsualMode), rplidar_value(Setting::kUsualMode, "")},
        Case{"half a number", rplidar_question(Setting::kUsualMode), rplidar_value(Setting::kUsualMode, "\x03")},
        Case{"a mode that cannot be asked for", rplidar_question(Setting::kUsualMode),
             rplidar_value(Setting::kUsualMode, std::string("\x00\x01", 2))},
        Case{"no time of a sample", sample, rplidar_value(Setting::kModeSample, "")},
        Case{"no answer about a sample", sample, ""},
        Case{"samples without time", sample, rplidar_value(Setting::kModeSample, std::string(4, '\0'))},
        Case{"samples that take seconds", sample, rplidar_value(Setting::kModeSample, std::string(4, '\x7F'))}}) {
    SCOPED_TRACE(told.what);
    AnsweredLine line("rplidar-a3", rplidar_line_params());
    line.answer_instead(told.question, told.answer);
    line.reset();
    line.run(3 * kSecond);
    EXPECT_EQ(line.asked(rplidar_asked(Command::kSampleTime)), 1);
    expect_streams_by(line, rplidar_express(0));
    EXPECT_EQ(line.asked(rplidar_asked(Command::kStop)), line.asked(rplidar_asked(Command::kInfo)));
  }
}

TEST(RplidarBringUp, AnOldLaserThatTellsNoTimesOfItsSamplesIsTakenToKnowTheStandardScanAlone) {
  for (const std::string& answer :
       {std::string(), rplidar_answer(0x15, "\x64"), rplidar_answer(0x99, std::string(4, '\x7F'))}) {
    AnsweredLine line("rplidar-a1-1.20", rplidar_line_params());
    line.answer_instead(rplidar_asked(Command::kSampleTime), answer);
    line.reset();
    line.run(3 * kSecond);
    expect_streams_by(line, rplidar_asked(Command::kScan));
  }
  AnsweredLine line("rplidar-a1-1.20", rplidar_line_params(RplidarScan::kExpress));
  line.answer_instead(rplidar_asked(Command::kSampleTime), "");
  line.reset();
  line.run(3 * kSecond);
  expect_streams_by(line, rplidar_express(0));
}

TEST(RplidarBringUp, ABrokenLaserIsToldWithItsStatusAndResetAfterAPause) {
  AnsweredLine line("rplidar-a2", rplidar_line_params());
  line.answer_instead(rplidar_asked(Command::kHealth), rplidar_answer(6, std::string("\x02\x00\x80", 3)), 1);
  line.reset();
  line.run(500 * kMs);
  ASSERT_EQ(line.heard().events.size(), 1U);
  EXPECT_EQ(line.heard().events[0].type, LrfEventType::kDeviceError);
  EXPECT_EQ(line.heard().events[0].device_status, 2);
  EXPECT_EQ(line.session().counters().device_errors, 1U);
  line.forget_requests();
  line.run(500 * kMs);
  EXPECT_TRUE(line.requests().empty());
  line.run(3 * kSecond);
  ASSERT_FALSE(line.requests().empty());
  EXPECT_EQ(line.requests().front(), rplidar_asked(Command::kReset));
  EXPECT_EQ(line.asked(rplidar_asked(Command::kReset)), 1);
  EXPECT_TRUE(line.session().ready());
}

TEST(RplidarBringUp, AWarningIsNoReasonNotToStream) {
  AnsweredLine line("rplidar-a2", rplidar_line_params());
  line.answer_instead(rplidar_asked(Command::kHealth), rplidar_answer(6, std::string("\x01\x00\x80", 3)));
  line.reset();
  line.run(2 * kSecond);
  expect_streams_by(line, rplidar_express(2));
}

// It answers one request with another's answer, or with half of one: it was not asked by us, and is asked anew.
TEST(RplidarBringUp, AnswersToSomethingElseAreNotTaken) {
  const std::string one_of_another = rplidar_value(Setting::kModeRange, std::string(4, '\x10'));
  for (const auto& [request, answer] :
       {std::pair(rplidar_asked(Command::kInfo), rplidar_answer(6, std::string(3, '\0'))),
        {rplidar_asked(Command::kHealth), rplidar_answer(4, std::string(20, '\x02'))},
        {rplidar_asked(Command::kHealth), rplidar_answer(6, "\x02")},
        {rplidar_question(Setting::kUsualMode), one_of_another},
        {rplidar_question(Setting::kUsualMode), rplidar_answer(0x21, std::string("\x7C\x00\x00\x00\x00\x00", 6))},
        {rplidar_question(Setting::kModeSample, 2), one_of_another}}) {
    AnsweredLine line("rplidar-a2", rplidar_line_params());
    line.answer_instead(request, answer, 1);
    line.reset();
    line.run(3 * kSecond);
    EXPECT_EQ(line.asked(request), 2);
    expect_streams_by(line, rplidar_express(2));
  }
}

TEST(RplidarBringUp, FindsAnAnswerBehindBytesThatAreNone) {
  const std::string info = rplidar_answer(4, "\x28\x18\x01\x05" + std::string(16, '\x07'));
  for (const std::string& before :
       {std::string("\xA5"), std::string("\xA5\xA5\xA5"), std::string("\x5A\x00\xA5\x00", 4),
        rplidar_answer(7, std::string(120, '\x11')).substr(0, 7)}) {
    AnsweredLine line("rplidar-a2", rplidar_line_params());
    line.answer_instead(rplidar_asked(Command::kInfo), before + info, 1);
    line.reset();
    line.run(2 * kSecond);
    EXPECT_EQ(line.asked(rplidar_asked(Command::kInfo)), 1);
    expect_streams_by(line, rplidar_express(2));
  }
}

TEST(RplidarBringUp, HalfAnAnswerSpoilsNotTheNext) {
  AnsweredLine line("rplidar-a2", rplidar_line_params());
  line.answer_instead(rplidar_asked(Command::kInfo), std::string("\xA5\x5A\x14\x00", 4), 4);
  line.reset();
  line.run(4 * kSecond);
  EXPECT_TRUE(line.session().ready());
  EXPECT_EQ(line.asked(rplidar_asked(Command::kInfo)), 5);
}

TEST(RplidarBringUp, AsksNothingBeforeTheLineIsQuietOrASecondIsOver) {
  for (const int noise_ms : {300, 980}) {
    AnsweredLine line("rplidar-a2", rplidar_line_params());
    line.reset();
    for (int ms = 0; ms < noise_ms; ms += 20) {
      line.run(20 * kMs);
      line.say("\xA5\x5A\x05");
    }
    EXPECT_THAT(line.requests(), ::testing::ElementsAre(rplidar_asked(Command::kStop))) << noise_ms;
    line.run(80 * kMs);
    EXPECT_GE(line.asked(rplidar_asked(Command::kInfo)), 1) << noise_ms;
  }
}

TEST(RplidarBringUp, TheMotorGetsWhatItsSeriesTakes) {
  struct Case {
    const char* model;
    int pwm;
    std::string speed;  ///< that the laser says, where the emulator is not asked; and nothing at all: "-"
    std::string request;
  };
  const std::string duty = rplidar_asked(Command::kMotorDuty, rplidar_number(660));
  for (const Case& motor :
       {Case{"rplidar-a1", 0, "", ""}, Case{"rplidar-a1-1.20", 0, "", ""}, Case{"rplidar-a2", 0, "", duty},
        Case{"rplidar-a2", 0, "-", duty}, Case{"rplidar-a2", 0, rplidar_value(Setting::kUsualSpeed, "\x58"), duty},
        Case{"rplidar-a3", 700, "", rplidar_asked(Command::kMotorDuty, rplidar_number(700))},
        Case{"rplidar-a3", 0, rplidar_value(Setting::kUsualSpeed, "\x58\x02\x2C\x01"),
             rplidar_asked(Command::kMotorDuty, rplidar_number(300))},
        Case{"rplidar-c1", 0, "", ""},
        Case{"rplidar-s1", 0, "", rplidar_asked(Command::kMotorSpeed, rplidar_number(600))},
        Case{"rplidar-s2", 0, "-", ""}}) {
    SCOPED_TRACE(motor.model);
    LrfParams params = rplidar_line_params();
    params.rplidar_pwm = motor.pwm;
    AnsweredLine line(motor.model, params);
    if (!motor.speed.empty()) {
      line.answer_instead(rplidar_question(Setting::kUsualSpeed), motor.speed == "-" ? "" : motor.speed);
    }
    line.reset();
    line.run(3 * kSecond);
    EXPECT_TRUE(line.session().ready());
    std::vector<std::string> told;
    std::ranges::copy_if(line.requests(), std::back_inserter(told), [](const std::string& asked) {
      return asked.starts_with("\xA5\xF0") || asked.starts_with("\xA5\xA8");
    });
    EXPECT_EQ(told, motor.request.empty() ? std::vector<std::string>{} : std::vector{motor.request});
  }
}

/// How often a laser is asked for its usual mode when its line is opened twice, the second time with other answers to
/// `request`.
int modes_asked(const std::string& request, const std::string& first, const std::string& second) {
  LrfParams params = rplidar_line_params();
  params.baud = 256000;  // or it would be answered at another
  AnsweredLine line("rplidar-a3", params);
  for (const std::string& answer : {first, second}) {
    line.in_its_stead = [=](const std::string& asked) {
      return asked == request && !answer.empty() ? std::optional(answer) : std::nullopt;
    };
    line.reset();
    line.run(2 * kSecond);
    EXPECT_TRUE(line.session().ready());
  }
  EXPECT_EQ(line.heard().count(LrfEventType::kReady), 2);
  return line.asked(rplidar_question(Setting::kUsualMode));
}

TEST(RplidarBringUp, AsksADeviceOnceWhichModesItHasAndAnotherDeviceAnew) {
  const std::string ask_info = rplidar_asked(Command::kInfo);
  const std::string info = rplidar_answer(4, "\x31\x1A\x01\x06" + std::string(16, '\x07'));
  const std::string other = rplidar_answer(4, "\x31\x1A\x01\x06" + std::string(16, '\x08'));
  EXPECT_EQ(modes_asked("", "", ""), 1);
  EXPECT_EQ(modes_asked(ask_info, info, info), 1);
  EXPECT_EQ(modes_asked(ask_info, info, other), 2) << "another serial number";
}

TEST(RplidarBringUp, AnOlderDeviceInTheFirstOnesPlaceIsTakenForWhatItIs) {
  LrfParams params = rplidar_line_params();
  params.baud = 115200;
  AnsweredLine line("rplidar-a2", params);
  line.reset();
  line.run(2 * kSecond);
  ASSERT_TRUE(line.session().ready());
  AnsweredLine fresh("rplidar-a2", params);
  for (AnsweredLine* const each : {&line, &fresh}) {
    each->forget_requests();
    each->in_its_stead = [](const std::string& asked) -> std::optional<std::string> {
      return asked == rplidar_asked(Command::kInfo)
                 ? std::optional(rplidar_answer(4, "\x28\x14\x01\x06" + std::string(16, '\x09')))
             : asked.starts_with("\xA5\x84") ? std::optional(std::string())
                                             : std::nullopt;
    };
    each->reset();
    each->run(2 * kSecond);
    EXPECT_TRUE(each->session().ready());
  }
  EXPECT_EQ(line.requests(), fresh.requests());
  EXPECT_EQ(line.session().geometry().range_max_m, fresh.session().geometry().range_max_m);
}

TEST(RplidarBringUp, ADeviceThatDidNotTellAllIsAskedAnew) {
  const std::string range = rplidar_question(Setting::kModeRange, 3);
  EXPECT_EQ(modes_asked(range, rplidar_value(Setting::kModeRange, ""), ""), 2);
}

TEST(RplidarBringUp, AStreamOfOtherPacketsThanAskedForIsRefusedAndAskedForAgain) {
  struct Case {
    RplidarScan scan;
    std::string answer;
  };
  for (const Case& refused : {Case{RplidarScan::kStandard, rplidar_answer(0x82, std::string(84, ' '), 1)},
                              Case{RplidarScan::kStandard, rplidar_answer(0x81, std::string(6, ' '), 1)},
                              Case{RplidarScan::kStandard, rplidar_answer(0x81, std::string(5, ' '), 0)},
                              Case{RplidarScan::kExpress, rplidar_answer(0x81, std::string(5, ' '), 1)},
                              Case{RplidarScan::kExpress, rplidar_answer(0x82, std::string(83, ' '), 1)},
                              Case{RplidarScan::kExpress, rplidar_answer(0x99, std::string(84, ' '), 1)}}) {
    AnsweredLine line("rplidar-a2", rplidar_line_params(refused.scan));
    const bool is_standard = refused.scan == RplidarScan::kStandard;
    line.answer_instead(is_standard ? "\xA5\x20" : "\xA5\x82", refused.answer, 1);
    line.reset();
    line.run(kSecond);
    EXPECT_FALSE(line.session().ready());
    ASSERT_EQ(line.heard().events.size(), 1U);
    EXPECT_EQ(line.heard().events[0].type, LrfEventType::kRejected);
    EXPECT_EQ(line.heard().events[0].reason, Errc::kFrameMalformed);
    line.run(2 * kSecond);
    EXPECT_TRUE(line.session().ready());
  }
}

TEST(RplidarBringUp, ALaserThatLeavesALastStepUnansweredIsToldOfOnceAndAskedOn) {
  for (const std::string& request :
       {rplidar_asked(Command::kHealth), rplidar_question(Setting::kModeAnswer, 2), rplidar_express(2)}) {
    AnsweredLine line("rplidar-a2", rplidar_line_params());
    line.answer_instead(request, "", 4);
    line.reset();
    line.run(900 * kMs);
    EXPECT_FALSE(line.session().ready());
    line.run(3 * kSecond);
    EXPECT_TRUE(line.session().ready());
    EXPECT_EQ(line.asked(request), 5);
    ASSERT_EQ(line.heard().events.size(), 2U);
    EXPECT_EQ(line.heard().events[0].reason, Errc::kDeviceSilent);
    EXPECT_EQ(line.heard().events[1].type, LrfEventType::kReady);
  }
}

}  // namespace
}  // namespace odoless
