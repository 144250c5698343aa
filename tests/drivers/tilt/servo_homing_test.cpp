// When a CANopen drive is to find its zero: once per power-up, as the drive itself knows.
#include <gtest/gtest.h>

#include <cstdint>
#include <map>

#include "tests/support/servo_support.hpp"

namespace odoless {
namespace {

using test::kServoMs;
using test::kServoSecond;
using test::ServoBench;

constexpr double kNearRad = 1e-3;

TiltParams homing_params(int method) {
  TiltParams params = test::servo_params(TiltDriver::kCia402);
  params.homing_method = method;
  return params;
}

/// Without an absolute encoder, as drives are that need homing.
std::unique_ptr<EmulatedServo> drive(const std::vector<Fault>& faults = {}, double droop_radps = 0.0) {
  Cia402DeviceOptions options;
  options.keeps_zero = false;
  options.home_rad = -0.1;
  options.droop_radps = droop_radps;
  options.faults = faults;
  return std::make_unique<Cia402Device>(options, 1000 * kServoSecond);
}

double axis_rad(ServoBench& bench) { return bench.servo_as<Cia402Device>().axis_rad(); }

void cut(ServoBench& bench) {
  bench.to_session = bench.to_servo = [](std::vector<ServoFrame>& frames) { frames.clear(); };
}

void join(ServoBench& bench) {
  bench.to_session = bench.to_servo = [](std::vector<ServoFrame>&) {};
}

/// Comes up, and then nods until it is far from its zero.
void nod(ServoBench& bench) {
  bench.reset();
  ASSERT_GT(bench.run_until(TiltState::kLevel, 8 * kServoSecond), 0);
  bench.command(TiltCommand::kSweep);
  ASSERT_GT(bench.run_until([&] { return std::abs(bench.angle_rad()) > 0.3; }, 4 * kServoSecond), 0);
}

/// How often it is homing until it is level.
int homings_until_level(ServoBench& bench) {
  bench.command(TiltCommand::kLevel);
  int homings = 0;
  bool was_homing = false;
  const auto is_level = [&] {
    const TiltState state = bench.session().state();
    homings += state == TiltState::kHoming && !was_homing ? 1 : 0;
    was_homing = state == TiltState::kHoming;
    return state == TiltState::kLevel;
  };
  EXPECT_GE(bench.run_until(is_level, 10 * kServoSecond), 0);
  bench.run(kServoSecond);
  return homings;
}

TEST(Cia402Homing, ADaemonThatStartsAnewTakesTheZeroThatTheDriveHas) {
  for (const auto& [method, zero_rad] : {std::pair{35, 0.2}, std::pair{37, 0.2}, std::pair{17, -0.1}}) {
    ServoBench bench(homing_params(method), drive());
    nod(bench);
    bench.restart_session();
    bench.reset();
    bench.run(100 * kServoMs);
    EXPECT_EQ(homings_until_level(bench), 0) << "method " << method;
    EXPECT_NEAR(axis_rad(bench), zero_rad, kNearRad);
  }
}

/// CiA 402-2, object 6099h: 1 to the switch, 2 to the zero, which is found the better the slower; 609Ah in the same
/// units.
TEST(Cia402Homing, TheLastWayToTheZeroIsFourTimesAsSlowAndTheAccelerationIsTheServos) {
  ServoBench bench(homing_params(17), drive());
  std::map<int, std::uint32_t> speeds;
  std::vector<std::uint32_t> accelerations;
  bench.to_servo = [&](std::vector<ServoFrame>& frames) {
    for (const ServoFrame& request : frames) {
      const CanFrame frame = *to_can_frame(request);
      if (frame.id == 0x601 && frame.data[0] == 0x23 && canopen::get(frame, 1, 2) == 0x6099) {
        speeds[frame.data[3]] = canopen::get(frame, 4, 4);
      }
      if (frame.id == 0x601 && frame.data[0] == 0x23 && canopen::get(frame, 1, 2) == 0x609A) {
        accelerations.push_back(canopen::get(frame, 4, 4));
      }
    }
  };
  bench.reset();
  ASSERT_GT(bench.run_until(TiltState::kLevel, 8 * kServoSecond), 0);
  ASSERT_EQ(speeds.size(), 2U);
  EXPECT_GT(speeds[2], 100U);
  EXPECT_EQ(speeds[2], speeds[1] / 4);
  ASSERT_EQ(accelerations.size(), 1U);
  const TiltParams params = homing_params(17);
  EXPECT_NEAR(accelerations[0] / (params.acceleration_radps2 / params.homing_speed_radps), speeds[1], 1.0);
}

TEST(Cia402Homing, AResetOfTheCommunicationMovesNoZero) {
  ServoBench bench(homing_params(35), drive());
  nod(bench);
  int resets = 0;
  bench.to_session = [](std::vector<ServoFrame>& frames) { frames.clear(); };
  bench.to_servo = [&](std::vector<ServoFrame>& frames) {
    for (const ServoFrame& frame : frames) {
      const CanFrame sent = *to_can_frame(frame);
      const bool is_reset = sent.id == canopen::kNmtCob &&
                            sent.data[0] == static_cast<std::uint8_t>(canopen::NmtCommand::kResetCommunication);
      resets += is_reset ? 1 : 0;
    }
  };
  ASSERT_GT(bench.run_until([&] { return resets > 0; }, 5 * kServoSecond), 0) << "after a few bring-ups that failed";
  join(bench);
  EXPECT_EQ(homings_until_level(bench), 0);
  EXPECT_NEAR(axis_rad(bench), 0.2, kNearRad);
}

TEST(Cia402Homing, ADriveThatWasOffWhileTheLinkWasDownFindsItsZeroAnew) {
  ServoBench bench(homing_params(17), drive({parse_fault("reboot@12:0.3")}, 0.2));
  nod(bench);
  bench.run(11 * kServoSecond - (bench.now_ns() - 1000 * kServoSecond));
  cut(bench);
  bench.run(2 * kServoSecond);
  join(bench);
  EXPECT_EQ(homings_until_level(bench), 1);
  EXPECT_NEAR(axis_rad(bench), -0.1, kNearRad);
  cut(bench);
  bench.run(2 * kServoSecond);
  join(bench);
  bench.run(100 * kServoMs);
  EXPECT_EQ(homings_until_level(bench), 0) << "this time it was on";
}

// Refuses its target of speed, as a drive does without that mode.
void refuse_mark(std::vector<ServoFrame>& frames) {
  for (ServoFrame& frame : frames) {
    CanFrame reply = *to_can_frame(frame);
    if (reply.id == canopen::kSdoReplyCob + 1 && canopen::get(reply, 1, 2) == 0x60FF) {
      reply.data[0] = 0x80;
      canopen::put(reply, 4, 0x06020000, 4);
      frame.assign(as_bytes(reply).begin(), as_bytes(reply).end());
    }
  }
}

TEST(Cia402Homing, ADriveThatCannotTellFindsItsZeroAtEachBringUp) {
  ServoBench bench(homing_params(17), drive());
  bench.to_session = refuse_mark;
  nod(bench);
  bench.reset();
  bench.run(100 * kServoMs);
  EXPECT_EQ(homings_until_level(bench), 1);
  EXPECT_NEAR(axis_rad(bench), -0.1, kNearRad);
}

TEST(Cia402Homing, ADriveThatCannotTellIsRefusedWhereHereWouldBeZero) {
  ServoBench bench(homing_params(35), drive());
  bench.to_session = refuse_mark;
  bench.reset();
  bench.run(2 * kServoSecond);
  EXPECT_EQ(bench.session().state(), TiltState::kBringUp);
  EXPECT_TRUE(bench.heard().has(TiltEventType::kLost, Errc::kDeviceStatus));
  EXPECT_TRUE(bench.heard().samples.empty());
  EXPECT_NEAR(axis_rad(bench), 0.2, kNearRad);
}

}  // namespace
}  // namespace odoless
