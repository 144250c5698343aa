// What the bring-up of a SICK that speaks SOPAS asks of the laser, and what it makes of each answer.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "tests/drivers/lrf/answered_line.hpp"

namespace odoless {
namespace {

using test::AnsweredLine;
using test::kMs;
using test::kSecond;
using ::testing::ElementsAre;

LrfParams sopas_line_params(SopasScan scan = SopasScan::kAsSet, int skip = 0) {
  LrfParams params;
  params.driver = LrfDriver::kSopas;
  params.device = "tcp://192.168.0.1:2111";
  params.sopas_scan = scan;
  params.skip = skip;
  return params;
}

std::string sopas_text(const std::string& content) { return '\x02' + content + '\x03'; }

const std::string kSopasStop = sopas_text("sEN LMDscandata 0");
const std::string kSopasLogIn = sopas_text("sMN SetAccessMode 03 F4724744");
const std::string kSopasAskScan = sopas_text("sRN LMPscancfg");
const std::string kSopasSetScan = sopas_text("sMN mLMPsetscancfg 9C4 1 9C4 FFF92230 225510");
const std::string kSopasContent = sopas_text("sWN LMDscandatacfg 01 00 0 1 0 00 00 0 0 0 0 1");
const std::string kSopasMeasure = sopas_text("sMN LMCstartmeas");
const std::string kSopasRun = sopas_text("sMN Run");
const std::string kSopasStart = sopas_text("sEN LMDscandata 1");

TEST(SopasBringUp, AsksInOrderAndWithoutDelay) {
  AnsweredLine line("lms111", sopas_line_params());
  line.reset();
  line.run(300 * kMs);
  EXPECT_TRUE(line.session().ready());
  EXPECT_THAT(line.requests(),
              ElementsAre(kSopasStop, kSopasLogIn, kSopasContent, kSopasMeasure, kSopasRun, kSopasStart));
}

TEST(SopasBringUp, SetsRateAndStepOverTheWholeFieldOfView) {
  AnsweredLine line("lms111", sopas_line_params(SopasScan::k25HzByQuarter));
  line.reset();
  line.run(7 * kSecond);
  EXPECT_TRUE(line.session().ready());
  EXPECT_THAT(line.requests(), ElementsAre(kSopasStop, kSopasLogIn, kSopasAskScan, kSopasSetScan, kSopasContent,
                                           kSopasMeasure, kSopasRun, kSopasStart));
  EXPECT_EQ(line.heard().events.size(), 1U) << "ready, and no complaint";
}

TEST(SopasBringUp, SetsThemWhereEitherDiffersOrItDoesNotTell) {
  for (const auto& [answer, is_set] : {std::pair("sRA LMPscancfg 9C4 1 9C4 FFF92230 225510", false),
                                       {"sRA LMPscancfg 1388 1 9C4 FFF92230 225510", true},
                                       {"sRA LMPscancfg 9C4 1 1388 FFF92230 225510", true},
                                       {"sRA LMPscancfg 9C4 1", true},
                                       {"sFA 3", true}}) {
    AnsweredLine line("lms111", sopas_line_params(SopasScan::k25HzByQuarter));
    line.answer_instead(kSopasAskScan, sopas_text(answer));
    line.reset();
    line.run(7 * kSecond);
    EXPECT_TRUE(line.session().ready());
    EXPECT_EQ(line.asked(kSopasSetScan), is_set ? 1 : 0) << answer;
  }
}

TEST(SopasBringUp, ARefusedSettingIsToldWithItsCodeAndTheLaserUsedAsItIs) {
  for (const auto& [answer, code] : {std::pair("sFA 5", 5), {"sAN mLMPsetscancfg 2 1388 1 1388 FFF92230 225510", -1}}) {
    AnsweredLine line("lms111", sopas_line_params(SopasScan::k25HzByQuarter));
    line.answer_instead(kSopasSetScan, sopas_text(answer));
    line.reset();
    line.run(7 * kSecond);
    ASSERT_TRUE(line.session().ready());
    EXPECT_EQ(line.session().geometry().beams, 541);
    EXPECT_EQ(line.session().geometry().period_ns, 20 * kMs);
    ASSERT_EQ(line.heard().count(LrfEventType::kDeviceError), 1);
    EXPECT_TRUE(line.heard().events[0].device_status == code || code < 0);
    EXPECT_NE(line.heard().events[0].device_status, 0);
  }
}

TEST(SopasBringUp, ARefusedContentMattersOnlyWhereScansAreToBeLeftOut) {
  for (const int skip : {0, 2}) {
    const std::string content = sopas_text("sWN LMDscandatacfg 01 00 0 1 0 00 00 0 0 0 0 " + std::to_string(skip + 1));
    AnsweredLine line("lms111", sopas_line_params(SopasScan::kAsSet, skip));
    line.answer_instead(content, sopas_text("sFA A"));
    line.reset();
    line.run(2 * kSecond);
    ASSERT_TRUE(line.session().ready());
    EXPECT_EQ(line.asked(content), 1);
    EXPECT_EQ(line.heard().count(LrfEventType::kDeviceError), skip > 0 ? 1 : 0);
    EXPECT_EQ(line.session().geometry().period_ns, 20 * kMs) << "every scan comes";
  }
}

TEST(SopasBringUp, ARefusedStreamIsToldAndAskedForAgainAfterAPause) {
  AnsweredLine line("lms111", sopas_line_params());
  line.answer_instead(kSopasStart, sopas_text("sFA 7"), 1);
  line.reset();
  line.run(300 * kMs);
  ASSERT_EQ(line.heard().events.size(), 1U);
  EXPECT_EQ(line.heard().events[0].type, LrfEventType::kDeviceError);
  EXPECT_EQ(line.heard().events[0].device_status, 7);
  line.forget_requests();
  line.run(600 * kMs);
  EXPECT_TRUE(line.requests().empty());
  line.run(kSecond);
  EXPECT_TRUE(line.session().ready());
}

TEST(SopasBringUp, TriesBothDialectsAndTellsThenThatNobodyAnswers) {
  AnsweredLine line("lms111", sopas_line_params());
  line.in_its_stead = [](const std::string&) { return std::optional<std::string>(""); };
  line.reset();
  line.run(390 * kMs);
  ASSERT_EQ(line.requests().size(), 2U);
  EXPECT_EQ(std::ranges::count_if(line.requests(),
                                  [](const std::string& asked) { return asked.starts_with("\x02\x02\x02\x02"); }),
            1);
  EXPECT_TRUE(line.heard().events.empty());
  line.run(3 * kSecond);
  ASSERT_EQ(line.heard().events.size(), 1U);
  EXPECT_EQ(line.heard().events[0].reason, Errc::kDeviceSilent);
}

TEST(SopasBringUp, ALaserThatAnswersTheFirstStepAloneIsToldOfOnce) {
  AnsweredLine line("lms111", sopas_line_params());
  line.answer_instead(kSopasRun, "");
  line.reset();
  line.run(12 * kSecond);
  EXPECT_FALSE(line.session().ready());
  EXPECT_GE(line.asked(kSopasRun), 8) << "it is asked on";
  ASSERT_EQ(line.heard().events.size(), 1U);
  EXPECT_EQ(line.heard().events[0].type, LrfEventType::kUnanswered);
}

TEST(SopasBringUp, AnswersOfOtherRequestsAreNotTaken) {
  AnsweredLine line("lms111", sopas_line_params());
  line.answer_instead(kSopasMeasure, sopas_text("sAN Run 1") + sopas_text("sRA DeviceIdent 1 A 1 B"), 1);
  line.reset();
  line.run(800 * kMs);
  EXPECT_EQ(line.asked(kSopasRun), 0);
  line.run(kSecond);
  EXPECT_TRUE(line.session().ready());
}

}  // namespace
}  // namespace odoless
