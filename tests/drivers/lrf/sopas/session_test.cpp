// SOPAS against the emulated lasers: settings, refusals, stamps, and what other clients are answered.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "drivers/lrf/sopas/bring_up.hpp"
#include "tests/tools/emulate_support.hpp"
#include "tools/emulate/sopas_device.hpp"

namespace odoless {
namespace {

using test::Bench;
using test::kMs;
using test::kSecond;
using ::testing::HasSubstr;

LrfParams sopas_params(SopasScan scan = SopasScan::kAsSet) {
  LrfParams params;
  params.driver = LrfDriver::kSopas;
  params.device = "tcp://192.168.0.1:2111";
  params.sopas_scan = scan;
  return params;
}

WorldDrive quiet_drive() {
  WorldDrive drive = test::small_drive();
  drive.noise_sd_m = 0.0;
  return drive;
}

class SopasModelTest : public ::testing::TestWithParam<const char*> {};

TEST_P(SopasModelTest, StampsAreThoseOfTheFirstBeamsWithDrift) {
  Bench bench(GetParam(), {.faults = {parse_fault("drift=200@3")}}, sopas_params(), quiet_drive());
  bench.reset();
  bench.run(15 * kSecond);
  const auto& sent = bench.sent();
  const auto& heard = bench.heard().scans;
  ASSERT_GT(heard.size(), 150U);
  for (std::size_t i = heard.size() / 3; i < heard.size(); ++i) {
    const SentScan& scan = sent[sent.size() - heard.size() + i];
    EXPECT_LT(std::abs(heard[i].stamp_ns - scan.first_beam_ns), kMs) << i;
  }
}

TEST_P(SopasModelTest, ComesToTheStreamFromEveryState) {
  for (const char* const before : {"", "\x02sMN Set", "\x02\x02\x02\x02\x01", "\x02sEN LMDscandata 1\x03",
                                   "\x02sMN SetAccessMode 03 F4724744\x03"}) {
    Bench bench(GetParam(), {}, sopas_params(), quiet_drive());
    bench.say(before);
    bench.reset();
    bench.run(5 * kSecond);
    EXPECT_GT(bench.heard().scans.size(), 20U) << before;
  }
}

INSTANTIATE_TEST_SUITE_P(Models, SopasModelTest, ::testing::Values("lms111", "tim551", "tim571", "lms4124"));

TEST(SopasSession, SetsAnLms111ToItsFinerStep) {
  Bench bench("lms111", {}, sopas_params(SopasScan::k25HzByQuarter), quiet_drive());
  bench.reset();
  bench.run(4 * kSecond);
  ASSERT_TRUE(bench.session().ready());
  EXPECT_EQ(bench.session().geometry().beams, 1081);
  EXPECT_EQ(bench.session().geometry().period_ns, 40 * kMs);
  EXPECT_EQ(bench.heard().count(LrfEventType::kDeviceError), 0);
  EXPECT_THAT(bench.written(), HasSubstr("mLMPsetscancfg"));
}

TEST(SopasSession, WritesNoSettingThatIsSo) {
  Bench bench("lms111", {}, sopas_params(SopasScan::k50HzByHalf), quiet_drive());
  bench.reset();
  bench.run(4 * kSecond);
  EXPECT_EQ(bench.session().geometry().beams, 541);
  EXPECT_THAT(bench.written(), HasSubstr("sRN LMPscancfg"));
  EXPECT_THAT(bench.written(), ::testing::Not(HasSubstr("mLMPsetscancfg")));
  EXPECT_THAT(bench.written(), ::testing::Not(HasSubstr("mEEwriteall"))) << "its memory wears";
}

// A TiM knows no other rate and step: it says so, and is used as it is.
TEST(SopasSession, UsesADeviceThatRefusesASettingAsItIs) {
  Bench bench("tim571", {}, sopas_params(SopasScan::k50HzByHalf), quiet_drive());
  bench.reset();
  bench.run(4 * kSecond);
  ASSERT_TRUE(bench.session().ready());
  EXPECT_EQ(bench.session().geometry().beams, 811);
  ASSERT_EQ(bench.heard().count(LrfEventType::kDeviceError), 1);
  EXPECT_EQ(bench.heard().events.front().device_status, 2) << "unknown method";
}

TEST(SopasSession, TellsTheDevicesStatusOnceEachTimeThatItIsBroughtUp) {
  Bench bench("lms111", {}, sopas_params(), quiet_drive());
  bench.on_the_way = [](std::string& bytes) {
    const std::string of_the_device = " A1B2C3 0 ";
    const std::size_t at = bytes.find(of_the_device);
    if (at != std::string::npos) {
      bytes.at(at + of_the_device.size()) = '1';  // an error
    }
  };
  for (int told = 1; told <= 2; ++told) {
    bench.reset();
    bench.run(4 * kSecond);
    ASSERT_TRUE(bench.session().ready());
    EXPECT_EQ(bench.heard().count(LrfEventType::kDeviceError), told);
    EXPECT_EQ(bench.heard().events.back().device_status, sopas::kDeviceStatus + 1);
  }
}

TEST(SopasSession, IsBroughtUpAnewWhereSomebodySetsTheDeviceOtherwise) {
  Bench bench("lms111", {}, sopas_params(), quiet_drive());
  bench.reset();
  bench.run(4 * kSecond);
  bench.say("\x02sMN SetAccessMode 03 F4724744\x03\x02sWN LMPoutputRange 1 1388 0 1B7740\x03");
  bench.run(4 * kSecond);
  ASSERT_TRUE(bench.session().ready());
  EXPECT_EQ(bench.session().geometry().beams, 361);
  EXPECT_NEAR(bench.session().geometry().start_angle_rad, -M_PI / 2.0, 1e-6);
  EXPECT_EQ(bench.session().counters().restarts, 1U);
}

TEST(SopasSession, SaysWhatHasTooManyBeams) {
  Bench bench("lms111", {}, sopas_params(), quiet_drive());
  const auto session = make_lrf_session(sopas_params(), 500);
  test::Heard heard;
  std::int64_t now_ns = bench.now_ns();
  session->reset(now_ns);
  for (int i = 0; i < 4000; ++i) {
    now_ns += kMs;
    const auto request = session->transmit();
    bench.device().receive({reinterpret_cast<const char*>(request.data()), request.size()}, now_ns);
    bench.device().tick(now_ns);
    for (const SentBytes& sent : bench.device().take_output()) {
      session->receive(std::as_bytes(std::span(sent.bytes.data(), sent.bytes.size())), now_ns, heard);
    }
    session->tick(now_ns, heard);
  }
  EXPECT_FALSE(session->ready());
  ASSERT_FALSE(heard.events.empty());
  EXPECT_EQ(heard.events.front().reason, Errc::kTooManyBeams);
}

// 600 scans a second are more than anyone needs of it.
TEST(SopasSession, AsksAnLms4124ForEveryTenthScan) {
  LrfParams params = sopas_params();
  params.skip = 9;
  Bench bench("lms4124", {}, params, quiet_drive());
  bench.reset();
  bench.run(4 * kSecond);
  ASSERT_TRUE(bench.session().ready());
  const LrfGeometry& geometry = bench.session().geometry();
  EXPECT_EQ(geometry.beams, 841);
  EXPECT_NEAR(geometry.start_angle_rad, -35.0 * M_PI / 180.0, 1e-6);
  EXPECT_NEAR(geometry.angle_step_rad, M_PI / 180.0 / 12.0, 1e-8);
  EXPECT_NEAR(geometry.range_max_m, 6.55, 0.01) << "it counts tenths of a millimetre";
  EXPECT_NEAR(static_cast<double>(geometry.period_ns), 1e9 / 60.0, 1000.0);
  const std::size_t before = bench.heard().scans.size();
  bench.run(kSecond);
  EXPECT_NEAR(static_cast<double>(bench.heard().scans.size() - before), 60.0, 2.0);
  EXPECT_NEAR(static_cast<double>(bench.heard().scans.back().beam_period_ns), 1e9 / 864'000.0, 1.0)
      << "its mirror's three faces see 120 deg each in the time of a scan";
}

TEST(SopasSession, SaysWhereADeviceRefusesToLeaveScansOut) {
  LrfParams params = sopas_params();
  params.skip = 1;
  Bench bench("lms111", {}, params, quiet_drive());
  bench.on_the_way = [](std::string& bytes) {
    bytes = bytes == "\x02sWA LMDscandatacfg\x03" ? "\x02sFA A\x03" : bytes;
  };
  bench.reset();
  bench.run(4 * kSecond);
  ASSERT_TRUE(bench.session().ready());
  ASSERT_EQ(bench.heard().count(LrfEventType::kDeviceError), 1);
  EXPECT_EQ(bench.heard().events.front().device_status, 10) << "writing is denied";
  EXPECT_EQ(bench.session().geometry().period_ns, 20 * kMs) << "every scan comes";
}

std::string answer_of(const char* model, const std::string& request) {
  WorldSource source(test::period_ns_of(model), quiet_drive());
  const auto device = make_emulated_lrf(model, source, {}, 0);
  device->receive(request, kSecond);
  std::string answer;
  for (const SentBytes& sent : device->take_output()) {
    answer += sent.bytes;
  }
  return answer;
}

TEST(SopasDevice, AnswersOtherClients) {
  EXPECT_EQ(answer_of("lms111", "\x02sRN DeviceIdent\x03"), "\x02sRA DeviceIdent 10 LMS11x_FieldEval 5 V1.36\x03");
  EXPECT_EQ(answer_of("lms111", "\x02sRN LMPscancfg\x03"), "\x02sRA LMPscancfg 1388 1 1388 FFF92230 225510\x03");
  EXPECT_EQ(answer_of("lms111", "\x02sMN SetAccessMode 03 F4724744\x03"), "\x02sAN SetAccessMode 1\x03");
  EXPECT_EQ(answer_of("lms111", "\x02sMN SetAccessMode 03 00000000\x03"), "\x02sAN SetAccessMode 0\x03");
  EXPECT_THAT(answer_of("tim551", "\x02sRN LMDscandata\x03"), HasSubstr("sRA LMDscandata 1 1 "));
}

TEST(SopasDevice, RefusesWithTheCodeForIt) {
  EXPECT_EQ(answer_of("lms111", "\x02sRN Nonsense\x03"), "\x02sFA 3\x03");
  EXPECT_EQ(answer_of("lms111", "\x02sMN Nonsense\x03"), "\x02sFA 2\x03");
  EXPECT_EQ(answer_of("lms111", "\x02sEN Nonsense 1\x03"), "\x02sFA F\x03");
  EXPECT_EQ(answer_of("lms111", "\x02sXX LMDscandata\x03"), "\x02sFA C\x03");
  EXPECT_EQ(answer_of("lms111", "\x02sWN LMPoutputRange 1 1388 0 1B7740\x03"), "\x02sFA A\x03") << "not logged in";
  EXPECT_EQ(answer_of("tim571", "\x02sRN DeviceIdent\x03"), "") << "it speaks CoLa B";
}

}  // namespace
}  // namespace odoless
