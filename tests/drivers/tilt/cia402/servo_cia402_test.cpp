// What is particular to CANopen drives, against an emulated one.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <utility>

#include "tests/support/servo_support.hpp"

namespace odoless {
namespace {

using canopen::NodeState;
using test::data_frame;
using test::faults_of;
using test::kServoMs;
using test::kServoSecond;
using test::servo_params;
using test::ServoBench;

TiltParams can_params() { return servo_params(TiltDriver::kCia402); }

ServoFrame bytes_of(const CanFrame& frame) { return {as_bytes(frame).begin(), as_bytes(frame).end()}; }

std::unique_ptr<EmulatedServo> drive(Cia402DeviceOptions options) {
  return std::make_unique<Cia402Device>(std::move(options), 1000 * kServoSecond);
}

TEST(Cia402Session, SetsTheDriveUp) {
  TiltParams params = can_params();
  params.id = 9;
  ServoBench bench(params);
  bench.reset();
  bench.run(kServoSecond);
  const auto& device = bench.servo_as<Cia402Device>();
  EXPECT_EQ(device.node_state(), NodeState::kOperational);
  EXPECT_EQ(device.power(), cia402::PowerState::kEnabled);
  EXPECT_EQ(device.dictionary().get({0x1017, 0}), 100U);
  EXPECT_EQ(device.dictionary().get({0x1016, 1}), 127U << 16U | 300U);
  EXPECT_EQ(device.dictionary().get({0x1800, 1}), 0x40000189U);
  EXPECT_EQ(device.dictionary().get({0x1800, 2}), 1U);
  EXPECT_EQ(device.dictionary().get({0x6081, 0}), 10923U) << "60 deg/s of 65536 per turn";
  EXPECT_EQ(device.dictionary().get_signed({0x607D, 1}), -8192);
  EXPECT_EQ(device.dictionary().get_signed({0x607D, 2}), 8192);
}

TEST(Cia402Session, TakesADriveOverFromEveryState) {
  for (const auto& before : std::vector<std::vector<CanFrame>>{
           {},
           {canopen::nmt(canopen::NmtCommand::kStart, 1)},
           {canopen::nmt(canopen::NmtCommand::kStop, 1)},
           {canopen::nmt(canopen::NmtCommand::kStart, 0), canopen::sdo_write(1, {0x6040, 0}, 6, 2),
            canopen::sdo_write(1, {0x6040, 0}, 7, 2), canopen::sdo_write(1, {0x6040, 0}, 15, 2),
            canopen::sdo_write(1, {0x6060, 0}, 1, 1), canopen::sdo_write(1, {0x607A, 0}, 30000, 4),
            canopen::sdo_write(1, {0x6040, 0}, 0x3F, 2)}}) {
    for (const bool resumes : {false, true}) {
      Cia402DeviceOptions options;
      options.resumes_stop = resumes;
      ServoBench bench(can_params(), drive(options));
      for (const CanFrame& frame : before) {
        bench.servo().receive(as_bytes(frame), bench.now_ns());
      }
      bench.reset();
      EXPECT_GT(bench.run_until(TiltState::kLevel, 3 * kServoSecond), 0);
      EXPECT_LE(bench.heard().count(TiltEventType::kLost), 0);
    }
  }
}

TEST(Cia402Session, FindsTheZeroOncePerPowerUp) {
  TiltParams params = can_params();
  params.homing_method = 17;
  params.at_start = TiltCommand::kStop;
  Cia402DeviceOptions options;
  options.home_rad = -0.4;
  options.faults = {parse_fault("silence@8:1"), parse_fault("reboot@14")};
  ServoBench bench(params, drive(options));
  bench.reset();
  bench.run(kServoSecond);
  EXPECT_EQ(bench.session().state(), TiltState::kHoming) << "it waits for leave to move";
  EXPECT_TRUE(bench.heard().samples.empty()) << "angles mean nothing yet";
  bench.command(TiltCommand::kLevel);
  EXPECT_GT(bench.run_until(TiltState::kLevel, 6 * kServoSecond), 0);
  EXPECT_NEAR(bench.servo().angle_rad(), 0.0, 1e-3) << "its zero is where the switch was";
  for (const TiltSample& sample : bench.heard().samples) {
    ASSERT_NEAR(sample.angle_rad, 0.0, 0.01);
  }
  int homings = 0;
  bool homing = false;
  bench.run_until(
      [&] {
        homings += !homing && bench.session().state() == TiltState::kHoming ? 1 : 0;
        homing = bench.session().state() == TiltState::kHoming;
        return false;
      },
      15 * kServoSecond);
  EXPECT_EQ(homings, 1) << "after the reboot, not after the silence";
}

TEST(Cia402Session, GivesAHomingUpThatNeverEnds) {
  TiltParams params = can_params();
  params.homing_method = 17;
  params.homing_timeout_ns = kServoSecond;
  ServoBench bench(params, faults_of("stall@0"));
  bench.reset();
  bench.run(3 * kServoSecond);
  EXPECT_TRUE(bench.heard().has(TiltEventType::kLost, Errc::kHomingFailed));
}

TEST(Cia402Session, TimeForWhichAHomingIsStoppedCountsNot) {
  TiltParams params = can_params();
  params.homing_method = 17;
  params.homing_timeout_ns = 4 * kServoSecond;
  Cia402DeviceOptions options;
  options.home_rad = -0.2;  // 2.3 s from where it starts
  ServoBench bench(params, drive(options));
  bench.reset();
  bench.run(kServoSecond);
  ASSERT_EQ(bench.session().state(), TiltState::kHoming);
  bench.command(TiltCommand::kStop);
  bench.run(10 * kServoSecond);
  EXPECT_EQ(bench.session().state(), TiltState::kHoming);
  EXPECT_EQ(bench.servo().velocity_radps(), 0.0);
  bench.command(TiltCommand::kLevel);
  EXPECT_GT(bench.run_until(TiltState::kLevel, 6 * kServoSecond), 0);
  EXPECT_EQ(bench.heard().count(TiltEventType::kLost), 0) << "nothing has failed";
}

TEST(Cia402Session, AStopWaitsForNoSync) {
  ServoBench bench(can_params());
  bench.reset();
  ASSERT_GT(bench.run_until(TiltState::kLevel, 3 * kServoSecond), 0);
  ASSERT_GE(
      bench.run_until([&] { return bench.session().next_deadline_ns() > bench.now_ns() + kServoMs; }, kServoSecond), 0);
  bench.command(TiltCommand::kStop);
  EXPECT_LE(bench.session().next_deadline_ns(), bench.now_ns());
}

TEST(Cia402Session, RefusesANodeThatIsNoDrive) {
  ServoBench bench(can_params());
  bench.to_session = [](std::vector<ServoFrame>& frames) {
    for (ServoFrame& frame : frames) {
      CanFrame changed = *to_can_frame(frame);
      if (changed.id == 0x581 && canopen::get(changed, 1, 2) == 0x1000) {
        canopen::put(changed, 4, 0x00030191, 4);  // an input and output module
      }
      frame = bytes_of(changed);
    }
  };
  bench.reset();
  bench.run(kServoSecond);
  EXPECT_TRUE(bench.heard().has(TiltEventType::kLost, Errc::kWrongDevice));
  EXPECT_EQ(bench.session().state(), TiltState::kBringUp);
}

/// A drive that refuses those values of an object so.
void refuse(ServoBench& bench, canopen::Object object, std::uint32_t abort_code, std::vector<std::uint32_t> values) {
  bench.to_servo = [&bench, object, abort_code, values = std::move(values),
                    was = bench.to_servo](std::vector<ServoFrame>& frames) {
    was(frames);
    std::erase_if(frames, [&](const ServoFrame& bytes) {
      const CanFrame frame = *to_can_frame(bytes);
      const bool is_write = frame.id == 0x601 && (frame.data[0] & 0xE0) == 0x20;
      const std::uint32_t value = canopen::get(frame, 4, 4 - (frame.data[0] >> 2 & 3));
      const bool is_refused = is_write && canopen::get(frame, 1, 2) == object.index && frame.data[3] == object.sub &&
                              (values.empty() || std::find(values.begin(), values.end(), value) != values.end());
      if (is_refused) {
        CanFrame answer = canopen::sdo_abort(1, object, abort_code);
        answer.id = 0x581;
        bench.session().receive(as_bytes(answer), bench.now_ns(), bench.heard());
      }
      return is_refused;
    });
  };
}

// As drives do that have them fixed, or know fewer values than the standard.
TEST(Cia402Session, DoesWithoutOptionalSettingsThatADriveRefusesForWhateverReason) {
  for (const canopen::Object object : {canopen::Object{0x1005, 0},
                                       {0x1016, 1},
                                       {0x1017, 0},
                                       {0x6007, 0},
                                       {0x605A, 0},
                                       {0x607D, 1},
                                       {0x607D, 2},
                                       {0x6084, 0},
                                       {0x6085, 0},
                                       {0x1400, 2},
                                       {0x1800, 5}}) {
    for (const std::uint32_t abort_code : {0x06090030U, 0x06040043U, 0x06040047U, 0x06020000U, 0x06090011U, 0x06070010U,
                                           0x08000000U, 0x08000020U, 0x06010002U}) {
      SCOPED_TRACE(testing::Message() << std::hex << object.index << ": " << abort_code);
      ServoBench bench(can_params());
      refuse(bench, object, abort_code, {});
      bench.reset();
      EXPECT_GT(bench.run_until(TiltState::kLevel, 3 * kServoSecond), 0);
      bench.run(kServoSecond);
      EXPECT_EQ(bench.session().state(), TiltState::kLevel);
      EXPECT_EQ(bench.heard().count(TiltEventType::kLost), 0);
      EXPECT_EQ(bench.heard().count(TiltEventType::kDeviceError), 0);
    }
  }
}

TEST(Cia402Session, TellsWhatADriveCannotDoByItself) {
  for (const auto& [object, lack] : {std::pair(canopen::Object{0x1016, 1}, TiltLack::kWatchOfDaemon),
                                     std::pair(canopen::Object{0x6007, 0}, TiltLack::kStopWithoutDaemon),
                                     std::pair(canopen::Object{0x605A, 0}, TiltLack::kHoldAfterStop),
                                     std::pair(canopen::Object{0x1017, 0}, TiltLack::kHeartbeat)}) {
    ServoBench bench(can_params());
    refuse(bench, object, 0x06090030U, {});
    bench.reset();
    bench.run(kServoSecond);
    EXPECT_EQ(bench.heard().count(TiltEventType::kDoesWithout), 1);
    EXPECT_EQ(bench.heard().events[0].code, static_cast<std::int64_t>(lack));
  }
}

TEST(Cia402Session, HoldsAStopTheOtherWayWhereADriveKnowsOnlyThat) {
  ServoBench bench(can_params());
  refuse(bench, {0x605A, 0}, 0x06090030U, {6});
  bench.reset();
  bench.run(kServoSecond);
  EXPECT_EQ(bench.servo_as<Cia402Device>().dictionary().get({0x605A, 0}), 5U);
  EXPECT_EQ(bench.heard().count(TiltEventType::kDoesWithout), 0);
}

TEST(Cia402Session, ADriveWithoutHeartbeatThatFallsSilentIsLostAllTheSame) {
  ServoBench bench(can_params(), faults_of("silence@2:1"));
  refuse(bench, {0x1017, 0}, 0x06010002U, {});
  bench.reset();
  bench.run(1900 * kServoMs);
  ASSERT_EQ(bench.session().state(), TiltState::kLevel);
  EXPECT_GE(bench.run_until(TiltState::kBringUp, 300 * kServoMs), 0);
  EXPECT_GE(bench.run_until(TiltState::kLevel, 3 * kServoSecond), 0);
}

TEST(Cia402Session, AnUnansweredOptionalSettingIsAskedAgainAndNotDoneWithout) {
  ServoBench bench(can_params());
  refuse(bench, {0x6007, 0}, 0x05040000U, {});
  bench.reset();
  bench.run(kServoSecond);
  EXPECT_EQ(bench.session().state(), TiltState::kBringUp);
  EXPECT_TRUE(bench.heard().has(TiltEventType::kLost, Errc::kDeviceStatus));
}

TEST(Cia402Session, TellsWhatADriveRefuses) {
  ServoBench bench(can_params());
  bench.to_session = [](std::vector<ServoFrame>& frames) {
    for (ServoFrame& frame : frames) {
      const CanFrame reply = *to_can_frame(frame);
      if (reply.id == 0x581 && canopen::get(reply, 1, 2) == 0x6081) {
        frame = bytes_of(data_frame(0x581, {0x80, 0x81, 0x60, 0, 0x30, 0, 0x09, 0x06}));
      } else if (reply.id == 0x581 && canopen::get(reply, 1, 2) == 0x605A) {
        frame = bytes_of(data_frame(0x581, {0x80, 0x5A, 0x60, 0, 0, 0, 0x02, 0x06}));
      }
    }
  };
  bench.reset();
  bench.run(200 * kServoMs);
  ASSERT_GE(bench.heard().events.size(), 1U);
  EXPECT_EQ(bench.heard().events[0].type, TiltEventType::kDeviceError);
  EXPECT_EQ(bench.heard().events[0].error, TiltError::kAbort);
  EXPECT_EQ(bench.heard().events[0].code, 0x06090030);
  EXPECT_EQ(bench.heard().events[0].object, 0x608100U);
}

TEST(Cia402Session, ComesBackAfterSomebodyElseStoppedTheNode) {
  for (const auto command : {canopen::NmtCommand::kStop, canopen::NmtCommand::kPreOperational,
                             canopen::NmtCommand::kResetNode, canopen::NmtCommand::kResetCommunication}) {
    ServoBench bench(can_params());
    bench.reset();
    bench.run(2 * kServoSecond);
    bench.servo().receive(as_bytes(canopen::nmt(command, 0)), bench.now_ns());
    EXPECT_GE(bench.run_until(TiltState::kBringUp, 300 * kServoMs), 0);
    EXPECT_GE(bench.run_until(TiltState::kLevel, kServoSecond), 0);
  }
}

TEST(Cia402Session, LosesABusThatIsOffAndComesBackWithinASecond) {
  ServoBench bench(can_params());
  bench.reset();
  bench.run(2 * kServoSecond);
  ASSERT_EQ(bench.session().state(), TiltState::kLevel);
  const CanFrame bus_off = data_frame(CanFrame::kErrorFlag | CanFrame::kErrorBusOff, {0, 0, 0, 0, 0, 0, 0, 0});
  bench.session().receive(as_bytes(bus_off), bench.now_ns(), bench.heard());
  EXPECT_EQ(bench.session().state(), TiltState::kBringUp);
  EXPECT_TRUE(bench.heard().has(TiltEventType::kBusError, Errc::kBusOff));
  const auto cut = [](std::vector<ServoFrame>& frames) { frames.clear(); };
  bench.to_session = cut;
  bench.to_servo = cut;
  bench.run(2 * kServoSecond);
  bench.to_session = bench.to_servo = [](std::vector<ServoFrame>&) {};
  const CanFrame restarted = data_frame(CanFrame::kErrorFlag | CanFrame::kErrorRestarted, {0, 0, 0, 0, 0, 0, 0, 0});
  bench.session().receive(as_bytes(restarted), bench.now_ns(), bench.heard());
  EXPECT_GE(bench.run_until(TiltState::kLevel, kServoSecond), 0);
}

TEST(Cia402Session, ABusThatIsBackIsUsedAtOnce) {
  ServoBench bench(can_params());
  bench.reset();
  bench.run(2 * kServoSecond);
  for (const std::uint32_t error : {CanFrame::kErrorBusOff, CanFrame::kErrorRestarted}) {
    const CanFrame frame = data_frame(CanFrame::kErrorFlag | error, {0, 0, 0, 0, 0, 0, 0, 0});
    bench.session().receive(as_bytes(frame), bench.now_ns(), bench.heard());
  }
  EXPECT_FALSE(bench.session().transmit().empty()) << "asks for its node";
}

TEST(Cia402Session, ALinkThatWasDownComesBackWithinASecond) {
  for (const std::int64_t down_ms : {100, 300, 1000, 4000}) {
    ServoBench bench(can_params());
    bench.reset();
    bench.run(2 * kServoSecond);
    bench.to_session = bench.to_servo = [](std::vector<ServoFrame>& frames) { frames.clear(); };
    bench.run(down_ms * kServoMs);
    bench.to_session = bench.to_servo = [](std::vector<ServoFrame>&) {};
    const std::size_t before = bench.heard().samples.size();
    const auto is_back = [&] {
      return bench.session().state() == TiltState::kLevel && bench.heard().samples.size() > before;
    };
    EXPECT_GE(bench.run_until(is_back, kServoSecond), 0) << down_ms << " ms";
  }
}

}  // namespace
}  // namespace odoless
