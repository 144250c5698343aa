// An RC servo at a Maestro, against an emulated one: what of the servos' contract holds where nobody measures.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <deque>

#include "drivers/tilt/maestro/command.hpp"
#include "tests/support/servo_support.hpp"

namespace odoless {
namespace {

using test::faults_of;
using test::kServoMs;
using test::kServoSecond;
using test::ServoBench;

constexpr std::int64_t kStartNs = 1000 * kServoSecond;
constexpr double kStepRad = 0.001;  ///< some counts of 16000 a turn

TiltParams maestro_params(TiltCommand at_start = TiltCommand::kLevel) {
  TiltParams params = test::servo_params(TiltDriver::kMaestro);
  params.at_start = at_start;
  params.channel = 2;
  return params;
}

/// One that was on before, and moves when it is told to.
std::unique_ptr<EmulatedServo> running_servo(double droop_radps = 0.0) {
  MaestroDeviceOptions options;
  options.channel = 2;
  options.is_on = true;
  options.droop_radps = droop_radps;
  return std::make_unique<MaestroDevice>(options, kStartNs);
}

void expect_samples_true(const ServoBench& bench, const std::vector<TiltSample>& samples) {
  std::int64_t last_ns = 0;
  for (const TiltSample& sample : samples) {
    ASSERT_GT(sample.stamp_ns, last_ns);
    ASSERT_NEAR(sample.angle_rad, bench.true_angle_rad(sample.stamp_ns), 0.02);
    last_ns = sample.stamp_ns;
  }
}

/// The sweep's middle, upwards, at full speed.
void sweep_to_the_middle(ServoBench& bench) {
  bench.reset();
  bench.run(2 * kServoSecond);
  ASSERT_GE(bench.run_until([&] { return bench.angle_rad() > 0.15 && bench.servo().velocity_radps() > 0.9; },
                            4 * kServoSecond),
            0);
}

TEST(MaestroCommands, AreThoseOfPololusGuide) {
  maestro::Commands commands;
  commands.add(maestro::Code::kSetTarget, 2, 6000).add(maestro::Code::kSetSpeed, 5, 140);
  const std::vector<int> expected{0x84, 0x02, 0x70, 0x2E, 0x87, 0x05, 0x0C, 0x01};
  std::vector<int> sent;
  for (const std::byte byte : commands.bytes()) {
    sent.push_back(std::to_integer<int>(byte));
  }
  EXPECT_EQ(sent, expected);
}

TEST(MaestroSession, ComesToTheLevelPoseAndSaysThatNobodyMeasures) {
  ServoBench bench(maestro_params(), running_servo());
  bench.reset();
  EXPECT_GT(bench.run_until(TiltState::kLevel, 3 * kServoSecond), 0);
  bench.run(kServoSecond);
  EXPECT_NEAR(bench.angle_rad(), 0.0, kStepRad);
  ASSERT_EQ(bench.heard().events.size(), 2U);
  EXPECT_EQ(bench.heard().events[0].type, TiltEventType::kReady);
  EXPECT_EQ(bench.heard().events[1].code, static_cast<std::int64_t>(TiltLack::kMeasurement));
  EXPECT_GT(bench.heard().samples.size(), 70U);
  expect_samples_true(bench, bench.heard().samples);
  EXPECT_EQ(bench.servo_as<MaestroDevice>().errors(), 0U);
}

TEST(MaestroSession, SweepsWithinTheLimitsAtItsSpeed) {
  TiltParams params = maestro_params(TiltCommand::kSweep);
  params.sweep_from_rad = -2.0;
  params.limit_min_rad = -0.6;
  params.inverted = true;
  params.level_angle_rad = 0.1;
  ServoBench bench(params, running_servo());
  bench.reset();
  bench.run(8 * kServoSecond);
  EXPECT_EQ(bench.session().state(), TiltState::kSweeping);
  double low_rad = 0.0;
  double high_rad = 0.0;
  for (const test::TrueAngle& angle : bench.truth()) {
    low_rad = std::min(low_rad, angle.angle_rad);
    high_rad = std::max(high_rad, angle.angle_rad);
  }
  EXPECT_NEAR(low_rad, -0.6, 0.01);
  EXPECT_NEAR(high_rad, params.sweep_to_rad, 0.01);
  EXPECT_EQ(bench.servo_as<MaestroDevice>().speed(), 27U) << "60 deg/s: 2667 counts/s";
  EXPECT_EQ(bench.servo_as<MaestroDevice>().acceleration(), 21U) << "600 deg/s2: 26667 counts/s2";
  expect_samples_true(bench, bench.heard().samples);
}

TEST(MaestroSession, TellsTheSpeedBetweenItsAngles) {
  ServoBench bench(maestro_params(TiltCommand::kSweep), running_servo());
  sweep_to_the_middle(bench);
  const std::vector<TiltSample>& samples = bench.heard().samples;
  ASSERT_GT(samples.size(), 100U);
  for (std::size_t i = 1; i < samples.size(); ++i) {
    const double elapsed_s = 1e-9 * static_cast<double>(samples[i].stamp_ns - samples[i - 1].stamp_ns);
    ASSERT_NEAR(samples[i].velocity_radps * elapsed_s, samples[i].angle_rad - samples[i - 1].angle_rad, 1e-9);
  }
  EXPECT_NEAR(samples.back().velocity_radps, 1.0, 0.1);
}

TEST(MaestroSession, StopsWithin200MsWithoutGoingBack) {
  ServoBench bench(maestro_params(TiltCommand::kSweep), running_servo());
  sweep_to_the_middle(bench);
  const double asked_rad = bench.angle_rad();
  bench.command(TiltCommand::kStop);
  EXPECT_GE(bench.run_until([&] { return bench.servo().velocity_radps() == 0.0; }, 200 * kServoMs), 0);
  const double stopped_rad = bench.angle_rad();
  EXPECT_GT(stopped_rad, asked_rad);
  EXPECT_LT(stopped_rad, asked_rad + 0.1);
  bench.run(3 * kServoSecond);
  EXPECT_EQ(bench.session().state(), TiltState::kStopped);
  EXPECT_NEAR(bench.angle_rad(), stopped_rad, kStepRad);
  bench.command(TiltCommand::kSweep);
  EXPECT_GE(bench.run_until([&] { return std::abs(bench.angle_rad() - stopped_rad) > 0.2; }, kServoSecond), 0);
}

TEST(MaestroSession, TellsTheProfileOnce) {
  ServoBench bench(maestro_params(), running_servo());
  int told = 0;
  bench.to_servo = [&](std::vector<ServoFrame>& frames) {
    for (const ServoFrame& frame : frames) {
      told += frame[0] == std::byte{0x87} ? 1 : 0;  // set speed
    }
  };
  bench.reset();
  bench.run(2 * kServoSecond);
  EXPECT_EQ(told, 1);
}

TEST(MaestroSession, ToldToStopItLeavesAServoThatIsOffAlone) {
  ServoBench bench(maestro_params(TiltCommand::kStop));
  bench.reset();
  bench.run(kServoSecond);
  EXPECT_EQ(bench.session().state(), TiltState::kStopped);
  EXPECT_FALSE(bench.servo_as<MaestroDevice>().has_pulse());
  bench.command(TiltCommand::kLevel);
  EXPECT_GE(bench.run_until(TiltState::kLevel, 100 * kServoMs), 0);
  EXPECT_TRUE(bench.servo_as<MaestroDevice>().has_pulse());
}

TEST(MaestroSession, StampsAreTakenBackByTheTimeOnTheLine) {
  TiltParams params = maestro_params();
  params.baud = 9600;
  ServoBench bench(params, running_servo());
  std::deque<std::vector<ServoFrame>> late(20);  // by 5 ms
  bench.to_session = [&](std::vector<ServoFrame>& frames) {
    late.push_back(std::exchange(frames, late.front()));
    late.pop_front();
  };
  bench.reset();
  bench.run(kServoSecond);
  ASSERT_GT(bench.heard().samples.size(), 10U);
  for (const TiltSample& sample : bench.heard().samples) {
    ASSERT_EQ(sample.arrival_ns - sample.stamp_ns, 2 * 10 * kServoSecond / 9600);
  }
}

TEST(MaestroSession, CountsItsBringUpsAfterTheFirst) {
  ServoBench bench(maestro_params(), running_servo());
  bench.reset();
  bench.reset();
  EXPECT_EQ(bench.session().counters().restarts, 1U);
}

TEST(MaestroSession, SilenceAndARebootAreToldOnceAndOver) {
  for (const std::string fault : {"silence@2:1", "reboot@2:0.3"}) {
    SCOPED_TRACE(fault);
    ServoBench bench(maestro_params(TiltCommand::kSweep), faults_of(fault));
    bench.reset();
    bench.run(2050 * kServoMs);
    EXPECT_GE(bench.run_until(TiltState::kBringUp, 400 * kServoMs), 0);
    bench.run(3 * kServoSecond);
    EXPECT_EQ(bench.heard().count(TiltEventType::kLost), 1);
    EXPECT_EQ(bench.heard().count(TiltEventType::kReady), 2);
    EXPECT_EQ(bench.session().state(), TiltState::kSweeping);
    EXPECT_EQ(bench.servo_as<MaestroDevice>().speed(), 27U);
    bench.to_session = [](std::vector<ServoFrame>& frames) { frames.clear(); };
    bench.reset();
    bench.run(3 * kServoSecond);
    EXPECT_EQ(bench.heard().count(TiltEventType::kLost), 2) << "once more when the line is opened anew";
  }
}

TEST(MaestroSession, ErrorsAreToldAndItGoesOn) {
  ServoBench bench(maestro_params(TiltCommand::kSweep), faults_of("error=16@2:0.1"));
  bench.reset();
  bench.run(4 * kServoSecond);
  EXPECT_EQ(bench.heard().count(TiltEventType::kDeviceError), 1);
  EXPECT_EQ(bench.heard().count(TiltEventType::kReady), 1);
  EXPECT_EQ(bench.session().state(), TiltState::kSweeping);
}

TEST(MaestroSession, AByteTooManyOrTooFewCostsAnAngle) {
  for (const bool is_lost : {false, true}) {
    ServoBench bench(maestro_params(TiltCommand::kSweep), running_servo());
    bench.reset();
    bench.run(kServoSecond);
    bool is_done = false;
    bench.to_session = [&](std::vector<ServoFrame>& frames) {
      if (!frames.empty() && !std::exchange(is_done, true)) {
        is_lost ? frames[0].pop_back() : frames[0].push_back(std::byte{0x12});
      }
    };
    bench.run(2 * kServoSecond);
    EXPECT_EQ(bench.session().state(), TiltState::kSweeping);
    EXPECT_EQ(bench.heard().count(TiltEventType::kLost), 0);
    EXPECT_EQ(bench.heard().count(TiltEventType::kReady), 1) << "not sought again";
    expect_samples_true(bench, bench.heard().samples);
  }
}

TEST(MaestroSession, IsLeftAsItIsTold) {
  for (const TiltEnd how : {TiltEnd::kHold, TiltEnd::kLevel, TiltEnd::kRelease}) {
    ServoBench bench(maestro_params(TiltCommand::kSweep), running_servo(0.5));
    sweep_to_the_middle(bench);
    const double asked_rad = bench.angle_rad();
    bench.session().finish(how, bench.now_ns());
    EXPECT_GE(bench.run_until([&] { return bench.session().is_finished(); }, 200 * kServoMs), 0);
    bench.host_asleep = true;
    bench.run(2 * kServoSecond);
    const auto& device = bench.servo_as<MaestroDevice>();
    EXPECT_EQ(device.has_pulse(), how != TiltEnd::kRelease);
    EXPECT_NEAR(bench.angle_rad(), how == TiltEnd::kLevel ? 0.0 : how == TiltEnd::kHold ? asked_rad + 0.05 : 1.0, 0.25);
    EXPECT_EQ(bench.session().next_deadline_ns(), std::numeric_limits<std::int64_t>::max());
  }
}

TEST(MaestroSession, BeforeItRunsItIsReleasedAsItIsToldAndElseLeftWhereItIs) {
  for (const TiltEnd how : {TiltEnd::kHold, TiltEnd::kLevel, TiltEnd::kRelease}) {
    ServoBench bench(maestro_params(), running_servo());
    bench.reset();
    const double left_rad = bench.angle_rad();
    bench.session().finish(how, bench.now_ns());
    bench.run(2 * kServoSecond);
    EXPECT_TRUE(bench.session().is_finished());
    EXPECT_EQ(bench.servo_as<MaestroDevice>().has_pulse(), how != TiltEnd::kRelease);
    EXPECT_NEAR(bench.angle_rad(), left_rad, how == TiltEnd::kRelease ? 1.0 : kStepRad);
  }
}

TEST(EmulatedMaestro, KnowsTheOtherProtocolsAndRefusesWhatIsNone) {
  MaestroDevice device({}, kStartNs);
  const auto said = [&](std::vector<int> bytes) {
    std::vector<std::byte> sent;
    std::ranges::transform(bytes, std::back_inserter(sent), [](int byte) { return static_cast<std::byte>(byte); });
    device.receive(sent, kStartNs);
    device.tick(kStartNs + kServoMs);
    std::vector<int> answer;
    for (const ServoFrame& frame : device.take_output()) {
      std::ranges::transform(frame, std::back_inserter(answer),
                             [](std::byte byte) { return std::to_integer<int>(byte); });
    }
    return answer;
  };
  EXPECT_EQ(said({0x90, 0}), (std::vector{0, 0})) << "off";
  EXPECT_EQ(said({0xAA, 12, 0x04, 0, 0x70, 0x2E, 0x90, 0}), (std::vector{0x70, 0x17})) << "6000";
  EXPECT_EQ(said({0xAA, 13, 0x04, 0, 0x00, 0x00, 0x90, 0}), (std::vector{0x70, 0x17})) << "of another device";
  EXPECT_EQ(said({0x9F, 1, 0, 0x00, 0x20, 0x90, 0}), (std::vector{0x00, 0x10})) << "4096";
  EXPECT_EQ(said({0xFF, 0, 254, 0x90, 0}), (std::vector{0x40, 0x1F})) << "8000";
  EXPECT_EQ(said({0xA1}), (std::vector{0, 0}));
  EXPECT_EQ(said({0x84, 0, 0x85}), (std::vector<int>{}));
  EXPECT_EQ(said({0xA1}), (std::vector{0x10, 0}));
  EXPECT_EQ(said({0xA1}), (std::vector{0, 0})) << "asked for, they are forgotten";
}

}  // namespace
}  // namespace odoless
