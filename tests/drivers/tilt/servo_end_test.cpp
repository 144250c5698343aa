// How a servo is left when the daemon ends, over both protocols.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "drivers/tilt/dynamixel/control_table.hpp"
#include "tests/support/servo_support.hpp"

namespace odoless {
namespace {

using test::kServoMs;
using test::kServoSecond;
using test::servo_params;
using test::ServoBench;

constexpr std::int64_t kPatienceNs = 200 * kServoMs;
constexpr double kResolutionRad = 0.0016;

class ServoEnd : public ::testing::TestWithParam<test::TestedServo> {
 protected:
  [[nodiscard]] static TiltParams params(TiltCommand at_start = TiltCommand::kSweep) {
    TiltParams params = servo_params(GetParam());
    params.at_start = at_start;
    return params;
  }
  /// A servo that sinks by `droop_radps` without torque.
  [[nodiscard]] static std::unique_ptr<EmulatedServo> servo(double droop_radps, std::vector<Fault> faults = {}) {
    return ServoBench::make_servo(params(), std::move(faults), {.start_rad = 0.2, .droop_radps = droop_radps});
  }
  /// In the middle of the sweep, so that it is far from anything it would come to by itself.
  static void sweep_to_the_middle(ServoBench& bench) {
    bench.reset();
    bench.run(2 * kServoSecond);
    ASSERT_GE(bench.run_until([&] { return bench.angle_rad() > 0.15 && bench.servo().velocity_radps() > 0.9; },
                              4 * kServoSecond),
              0);
  }
  /// Ends as the daemon does, which is gone after that: the servo hears no more.
  static void end(ServoBench& bench, TiltEnd how) {
    bench.session().finish(how, bench.now_ns());
    EXPECT_GE(bench.run_until([&] { return bench.session().is_finished(); }, kPatienceNs), 0);
    bench.run(5 * kServoMs);  // what is on its way
    bench.host_asleep = true;
  }
  static bool has_torque(ServoBench& bench) {
    if (GetParam().driver == TiltDriver::kDynamixel) {
      return bench.servo_as<DynamixelDevice>().get(dynamixel::kTorqueEnable, 1) != 0;
    }
    const cia402::PowerState power = bench.servo_as<Cia402Device>().power();
    return power == cia402::PowerState::kEnabled || power == cia402::PowerState::kQuickStop;
  }
  /// Nothing is wrong with it, and it waits for no sign of life.
  static void expect_left_in_order(ServoBench& bench) {
    if (GetParam().driver == TiltDriver::kDynamixel) {
      EXPECT_EQ(bench.servo_as<DynamixelDevice>().get(dynamixel::kBusWatchdog, 1), 0U);
    } else {
      EXPECT_EQ(bench.servo_as<Cia402Device>().dictionary().get({0x1016, 1}), 0U);
      EXPECT_EQ(bench.servo_as<Cia402Device>().dictionary().get({0x1001, 0}), 0U);
      EXPECT_EQ(bench.servo_as<Cia402Device>().node_state(), canopen::NodeState::kOperational);
    }
  }
};

INSTANTIATE_TEST_SUITE_P(Servos, ServoEnd, ::testing::ValuesIn(test::kTestedServos),
                         [](const auto& tested) { return std::string(tested.param.name); });

TEST_P(ServoEnd, HoldStopsItAndItStaysThere) {
  ServoBench bench(params(), servo(0.5));
  sweep_to_the_middle(bench);
  const double asked_rad = bench.angle_rad();
  end(bench, TiltEnd::kHold);
  bench.run(kPatienceNs);
  const double held_rad = bench.angle_rad();
  EXPECT_NEAR(held_rad, asked_rad, 0.15) << "it stops at once, not at the end of its way";
  bench.run(5 * kServoSecond);
  EXPECT_NEAR(bench.angle_rad(), held_rad, kResolutionRad) << "it has torque, long after the daemon";
  expect_left_in_order(bench);
}

TEST_P(ServoEnd, LevelIsComeToThoughNobodyIsThereAnyMore) {
  ServoBench bench(params(), servo(0.5));
  sweep_to_the_middle(bench);
  end(bench, TiltEnd::kLevel);
  EXPECT_GT(std::abs(bench.angle_rad()), 0.05) << "it is not there yet";
  bench.run(5 * kServoSecond);
  EXPECT_NEAR(bench.angle_rad(), 0.0, 2 * kResolutionRad);
  expect_left_in_order(bench);
}

TEST_P(ServoEnd, ReleaseTakesItsTorque) {
  ServoBench bench(params(), servo(0.5));
  sweep_to_the_middle(bench);
  end(bench, TiltEnd::kRelease);
  EXPECT_FALSE(has_torque(bench));
  const double released_rad = bench.angle_rad();
  bench.run(kServoSecond);
  EXPECT_NEAR(bench.angle_rad() - released_rad, 0.5, 0.02) << "it sinks";
  expect_left_in_order(bench);
}

TEST_P(ServoEnd, AStoppedOrFaultyServoIsNotSentToLevel) {
  for (const std::string fault : {"", "stall@2:30"}) {
    ServoBench bench(params(fault.empty() ? TiltCommand::kStop : TiltCommand::kSweep),
                     servo(0.0, fault.empty() ? std::vector<Fault>{} : std::vector{parse_fault(fault)}));
    bench.reset();
    bench.run(3 * kServoSecond);
    ASSERT_EQ(bench.session().state(), fault.empty() ? TiltState::kStopped : TiltState::kFault);
    const double resting_rad = bench.angle_rad();
    end(bench, fault.empty() ? TiltEnd::kHold : TiltEnd::kLevel);
    bench.run(3 * kServoSecond);
    EXPECT_NEAR(bench.angle_rad(), resting_rad, 2 * kResolutionRad);
  }
}

// Whatever it is at, the end comes within the time that the daemon has, and nothing is sent behind it.
TEST_P(ServoEnd, EndsInTimeFromEveryStateAndSaysNoMoreThen) {
  for (const TiltEnd how : {TiltEnd::kHold, TiltEnd::kLevel, TiltEnd::kRelease}) {
    for (std::int64_t after_ns = 0; after_ns < 300 * kServoMs; after_ns += 7 * kServoMs / 4) {
      ServoBench bench(params());
      bench.reset();
      bench.run(after_ns);
      bench.session().finish(how, bench.now_ns());
      ASSERT_GE(bench.run_until([&] { return bench.session().is_finished(); }, kPatienceNs), 0)
          << "ended " << after_ns / kServoMs << " ms after its start";
      bench.run(5 * kServoMs);
      EXPECT_TRUE(how != TiltEnd::kRelease || !has_torque(bench)) << after_ns / kServoMs << " ms";
      std::size_t sent = 0;
      bench.to_servo = [&](std::vector<ServoFrame>& frames) { sent += frames.size(); };
      bench.run(kServoSecond);
      EXPECT_EQ(sent, 0U);
      EXPECT_EQ(bench.session().next_deadline_ns(), std::numeric_limits<std::int64_t>::max());
    }
  }
}

TEST_P(ServoEnd, AServoThatDoesNotAnswerKeepsNobodyWaiting) {
  ServoBench bench(params(), servo(0.0, {parse_fault("silence@1")}));
  bench.reset();
  bench.run(1050 * kServoMs);
  bench.session().finish(TiltEnd::kHold, bench.now_ns());
  EXPECT_GE(bench.run_until([&] { return bench.session().is_finished(); }, 250 * kServoMs), 0);
  EXPECT_EQ(bench.heard().count(TiltEventType::kLost), 0) << "what would be done about it?";
}

TEST_P(ServoEnd, AResetAfterItsEndBringsItUpAgain) {
  for (const TiltEnd how : {TiltEnd::kHold, TiltEnd::kLevel, TiltEnd::kRelease}) {
    ServoBench bench(params(TiltCommand::kLevel), servo(0.0));
    bench.reset();
    bench.run(kServoSecond);
    bench.session().finish(how, bench.now_ns());
    bench.run(kPatienceNs);
    ASSERT_TRUE(bench.session().is_finished());
    bench.reset();
    bench.command(TiltCommand::kLevel);
    bench.run(2 * kServoSecond);
    EXPECT_FALSE(bench.session().is_finished());
    EXPECT_EQ(bench.session().state(), TiltState::kLevel);
    const std::size_t before = bench.heard().samples.size();
    bench.run(kServoSecond);
    EXPECT_NEAR(static_cast<double>(bench.heard().samples.size() - before), 100.0, 3.0);
  }
}

TEST_P(ServoEnd, TheNextDaemonFindsItInOrder) {
  for (const TiltEnd how : {TiltEnd::kHold, TiltEnd::kLevel, TiltEnd::kRelease}) {
    ServoBench bench(params(), servo(0.0));
    sweep_to_the_middle(bench);
    end(bench, how);
    bench.run(3 * kServoSecond);
    bench.host_asleep = false;
    bench.restart_session();
    bench.reset();
    EXPECT_GT(bench.run_until(TiltState::kSweeping, 2 * kServoSecond), 0);
    EXPECT_EQ(bench.heard().count(TiltEventType::kDeviceError), 0);
  }
}

}  // namespace
}  // namespace odoless
