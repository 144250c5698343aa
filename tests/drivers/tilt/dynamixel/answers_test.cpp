// What a session makes of each answer of a Dynamixel: refusals, alerts, settings that differ, answers that are not its
// own. Some of what the emulated servo says is replaced on its way.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <vector>

#include "drivers/tilt/dynamixel/control_table.hpp"
#include "drivers/tilt/dynamixel/packet.hpp"
#include "tests/support/servo_support.hpp"

namespace odoless {
namespace {

using dynamixel::Instruction;
using test::kServoMs;
using test::kServoSecond;
using test::ServoBench;

using DynamixelBytes = std::vector<std::uint8_t>;

constexpr std::size_t kPositionAt = 1 + dynamixel::kPresentPosition - dynamixel::kMotionFirst;  ///< behind the error

TiltParams dynamixel_params() { return test::servo_params(TiltDriver::kDynamixel); }

/// A servo in its level pose.
std::unique_ptr<DynamixelDevice> level_dynamixel(bool echoes = false, std::int64_t latency_ns = kServoMs / 2) {
  DynamixelDeviceOptions options;
  options.start_rad = 0.0;
  options.echoes = echoes;
  options.latency_ns = latency_ns;
  return std::make_unique<DynamixelDevice>(std::move(options), 1000 * kServoSecond);
}

ServoFrame dynamixel_frame(int id, Instruction instruction, const DynamixelBytes& parameters) {
  const dynamixel::PacketBytes packet = dynamixel::encode(id, instruction, parameters);
  const auto bytes = std::as_bytes(packet.span());
  return {bytes.begin(), bytes.end()};
}

/// Somebody else's write to all servos, which none answers.
ServoFrame dynamixel_write(std::uint16_t address, const DynamixelBytes& data) {
  DynamixelBytes parameters{static_cast<std::uint8_t>(address & 0xFFU), static_cast<std::uint8_t>(address >> 8U)};
  parameters.insert(parameters.end(), data.begin(), data.end());
  constexpr int kAll = 254;
  return dynamixel_frame(kAll, Instruction::kWrite, parameters);
}

/// Whether it reads or writes at that address.
bool is_request(const ServoFrame& frame, Instruction instruction, std::uint16_t address) {
  return frame.size() > 9 && frame[7] == static_cast<std::byte>(instruction) &&
         std::to_integer<unsigned>(frame[8]) + 256U * std::to_integer<unsigned>(frame[9]) == address;
}

/// An answer to the read of clock, speed and position, and error and data of it.
bool tells_motion(const ServoFrame& frame) {
  return frame.size() == 11U + dynamixel::kMotionBytes && frame[7] == std::byte{0x55};
}
DynamixelBytes content_of(const ServoFrame& frame) {
  DynamixelBytes content;
  std::transform(frame.begin() + 8, frame.end() - 2, std::back_inserter(content),
                 [](std::byte byte) { return std::to_integer<std::uint8_t>(byte); });
  return content;
}

/// A servo that is level and told so, whose next answers to the read of its motion are changed.
class DynamixelAnswers : public ::testing::Test {
 protected:
  explicit DynamixelAnswers(const TiltParams& params = dynamixel_params()) : bench_(params, level_dynamixel()) {}

  void SetUp() override {
    bench_.reset();
    ASSERT_GT(bench_.run_until(TiltState::kLevel, 2 * kServoSecond), 0);
    bench_.run(300 * kServoMs);
    events_before_ = bench_.heard().events.size();
  }

  /// The next `count` of them become what `change` makes of their error and data, of the servo with that id.
  void change_motion(int count, std::function<void(DynamixelBytes&)> change, int id = 1) {
    bench_.to_session = [=, left = count](std::vector<ServoFrame>& frames) mutable {
      for (ServoFrame& frame : frames) {
        if (tells_motion(frame) && left > 0) {
          DynamixelBytes content = content_of(frame);
          change(content);
          frame = dynamixel_frame(id, Instruction::kStatus, content);
          --left;
        }
      }
    };
  }

  void expect_samples_level() {
    for (const TiltSample& sample : bench_.heard().samples) {
      ASSERT_NEAR(sample.angle_rad, 0.0, 0.003);
    }
  }
  [[nodiscard]] std::size_t new_events() { return bench_.heard().events.size() - events_before_; }
  /// The longest time between two of the last `count` samples.
  [[nodiscard]] std::int64_t longest_gap_ns(std::size_t count) {
    const std::vector<TiltSample>& samples = bench_.heard().samples;
    std::int64_t longest_ns = 0;
    for (std::size_t i = samples.size() - count + 1; i < samples.size(); ++i) {
      longest_ns = std::max(longest_ns, samples[i].arrival_ns - samples[i - 1].arrival_ns);
    }
    return longest_ns;
  }

  ServoBench bench_;
  std::size_t events_before_ = 0;
};

TEST_F(DynamixelAnswers, OneOfAnotherServoInItsPlaceIsNotTaken) {
  change_motion(
      1, [](DynamixelBytes& content) { content[kPositionAt + 1] ^= 0x01U; }, 2);
  bench_.run(200 * kServoMs);
  expect_samples_level();
  ASSERT_EQ(new_events(), 1U);
  EXPECT_EQ(bench_.heard().events.back().reason, Errc::kWrongEcho);
  EXPECT_EQ(bench_.session().counters().timeouts, 1U) << "its own is waited for";
}

TEST_F(DynamixelAnswers, OneOfAnotherSizeIsNotTaken) {
  for (const std::size_t size : {3U, 16U, 18U}) {
    change_motion(1, [=](DynamixelBytes& content) { content.resize(size); });
    bench_.run(200 * kServoMs);
  }
  expect_samples_level();
  ASSERT_EQ(new_events(), 3U);
  EXPECT_EQ(bench_.heard().events.back().reason, Errc::kWrongCount);
}

TEST_F(DynamixelAnswers, AnAngleThatCannotBeIsRefusedAndTheNextTaken) {
  change_motion(1, [](DynamixelBytes& content) { content[kPositionAt + 1] ^= 0x04U; });
  bench_.run(200 * kServoMs);
  expect_samples_level();
  EXPECT_EQ(bench_.session().counters().implausible, 1U);
  ASSERT_EQ(new_events(), 1U);
  EXPECT_EQ(bench_.heard().events.back().reason, Errc::kImplausibleAngle);
  EXPECT_LE(longest_gap_ns(20), 25 * kServoMs);
}

// The servo says so where it can; else its silence is waited for, which costs 50 ms.
TEST_F(DynamixelAnswers, WhatWasDamagedOnItsWayToItIsAskedAgainSoon) {
  change_motion(2, [](DynamixelBytes& content) { content = {dynamixel::kCrcError}; });
  bench_.run(200 * kServoMs);
  EXPECT_LE(longest_gap_ns(20), 35 * kServoMs);
  EXPECT_EQ(bench_.session().counters().wrong_sums, 2U);
  EXPECT_EQ(bench_.session().counters().restarts, 0U);
  EXPECT_TRUE(bench_.heard().has(TiltEventType::kRejected, Errc::kWrongSum));
}

TEST_F(DynamixelAnswers, TwoLostInThreeAreNoReasonToGiveItUpAndThreeInARowAre) {
  bench_.to_session = [count = 0](std::vector<ServoFrame>& frames) mutable {
    std::erase_if(frames, [&](const ServoFrame& frame) { return tells_motion(frame) && count++ % 3 != 0; });
  };
  bench_.run(2 * kServoSecond);
  EXPECT_EQ(new_events(), 0U);
  bench_.to_session = [](std::vector<ServoFrame>& frames) { std::erase_if(frames, tells_motion); };
  bench_.run(200 * kServoMs);
  EXPECT_TRUE(bench_.heard().has(TiltEventType::kLost, Errc::kDeviceSilent));
}

TEST_F(DynamixelAnswers, AClockThatStartsAnewIsToldAtOnceAndOneThatIsOffALittleIsNot) {
  const auto shift_ms = [&](int by_ms, int count) {
    change_motion(count, [=](DynamixelBytes& content) {
      const int tick_ms = (content[1] + 256 * content[2] + by_ms + dynamixel::kTickWrapMs) % dynamixel::kTickWrapMs;
      content[1] = static_cast<std::uint8_t>(tick_ms & 0xFF);
      content[2] = static_cast<std::uint8_t>(tick_ms >> 8);
    });
    bench_.run(25 * kServoMs);
  };
  for (const int by_ms : {-450, 450, -200}) {
    shift_ms(by_ms, 3);
    bench_.run(100 * kServoMs);
    EXPECT_EQ(new_events(), 0U) << by_ms;
  }
  int told = 0;
  for (const int by_ms : {-600, 600, -10'000}) {
    shift_ms(by_ms, 1);
    EXPECT_EQ(bench_.heard().count(TiltEventType::kLost), ++told) << by_ms;
    EXPECT_TRUE(bench_.heard().has(TiltEventType::kLost, Errc::kDeviceRestarted));
    bench_.run(kServoSecond);
    EXPECT_EQ(bench_.session().state(), TiltState::kLevel);
  }
}

TEST_F(DynamixelAnswers, AClockThatWrapsHasNotStartedAnew) {
  bench_.run(34 * kServoSecond);
  EXPECT_EQ(new_events(), 0U);
  EXPECT_EQ(bench_.session().counters().restarts, 0U);
}

TEST_F(DynamixelAnswers, ATorqueThatSomebodyElseTookAwayIsNoticedAndGivenBack) {
  bench_.servo().receive(dynamixel_write(dynamixel::kTorqueEnable, {0}), bench_.now_ns());
  EXPECT_GE(bench_.run_until([&] { return new_events() > 0; }, 200 * kServoMs), 0);
  EXPECT_TRUE(bench_.heard().has(TiltEventType::kLost, Errc::kDeviceRestarted));
  bench_.run(kServoSecond);
  EXPECT_EQ(bench_.session().state(), TiltState::kLevel);
  EXPECT_EQ(bench_.servo_as<DynamixelDevice>().get(dynamixel::kTorqueEnable, 1), 1U);
  EXPECT_EQ(bench_.heard().count(TiltEventType::kLost), 1);
}

TEST_F(DynamixelAnswers, ItsHealthIsLookedAtOncePerTenAngles) {
  int healths = 0;
  int motions = 0;
  bench_.to_servo = [&](std::vector<ServoFrame>& frames) {
    for (const ServoFrame& frame : frames) {
      healths += is_request(frame, Instruction::kRead, dynamixel::kHealthFirst) ? 1 : 0;
      motions += is_request(frame, Instruction::kRead, dynamixel::kMotionFirst) ? 1 : 0;
    }
  };
  bench_.run(kServoSecond);
  EXPECT_NEAR(motions, 100, 2);
  EXPECT_NEAR(healths, 10, 1);
}

// Every answer has a bit for it: the next look at its health is not waited for.
TEST(DynamixelAlert, IsFollowedAtOnce) {
  for (int ms = 1000; ms < 1100; ms += 10) {
    ServoBench bench(dynamixel_params(), test::faults_of("error=32@" + std::to_string(ms / 1000.0) + ":0.05"));
    bench.reset();
    bench.run(ms * kServoMs);
    ASSERT_EQ(bench.heard().count(TiltEventType::kDeviceError), 0);
    EXPECT_GE(bench.run_until([&] { return bench.heard().count(TiltEventType::kDeviceError) > 0; }, 30 * kServoMs), 0);
    EXPECT_EQ(bench.heard().events.back().reason, Errc::kDeviceStatus);
  }
}

TEST(DynamixelAlert, OneThatPassesCostsTheSameEachTimeAndOneThatStaysIsLookedAtMoreAndMoreRarely) {
  std::vector<Fault> faults;
  for (const char* const text : {"error=32@2:0.05", "error=32@6:0.05", "error=32@10:0.05", "error=32@14:12"}) {
    faults.push_back(parse_fault(text));
  }
  ServoBench bench(dynamixel_params(), std::move(faults));
  bench.reset();
  bench.run(2 * kServoSecond);
  std::vector<std::int64_t> took_ns;
  for (int i = 0; i < 3; ++i) {
    bench.run(100 * kServoMs);
    took_ns.push_back(bench.run_until(TiltState::kLevel, 2 * kServoSecond));
    bench.run(3900 * kServoMs - took_ns.back());
  }
  const auto [least, most] = std::ranges::minmax_element(took_ns);
  EXPECT_GT(*least, 0);
  EXPECT_LT(*most, 1200 * kServoMs);
  EXPECT_LT(*most - *least, 50 * kServoMs);
  const int before = bench.heard().count(TiltEventType::kDeviceError);
  bench.run(12 * kServoSecond);
  EXPECT_GE(bench.heard().count(TiltEventType::kDeviceError) - before, 5);
  EXPECT_LE(bench.heard().count(TiltEventType::kDeviceError) - before, 8);
}

TEST(DynamixelRefusal, IsToldWithNumberAndAddressAndTriedAgain) {
  for (const std::uint16_t address : {dynamixel::kReturnDelay, dynamixel::kOperatingMode, dynamixel::kPositionMax,
                                      dynamixel::kTorqueEnable, dynamixel::kBusWatchdog, dynamixel::kProfile}) {
    SCOPED_TRACE(address);
    ServoBench bench(dynamixel_params());
    bool is_refused = false;
    bench.to_servo = [&](std::vector<ServoFrame>& frames) {
      if (!is_refused && !frames.empty() && is_request(frames[0], Instruction::kWrite, address)) {
        is_refused = true;
        frames.clear();
        const ServoFrame refusal = dynamixel_frame(1, Instruction::kStatus, {5});
        bench.session().receive(refusal, bench.now_ns(), bench.heard());
      }
    };
    bench.reset();
    bench.run(kServoSecond);
    ASSERT_TRUE(is_refused);
    ASSERT_GE(bench.heard().events.size(), 3U);
    const TiltEvent refused{.type = TiltEventType::kDeviceError,
                            .reason = Errc::kDeviceStatus,
                            .error = TiltError::kErrorNumber,
                            .code = 5,
                            .object = address};
    EXPECT_EQ(bench.heard().events[0], refused);
    EXPECT_EQ(bench.heard().events[1].type, TiltEventType::kLost);
    EXPECT_EQ(bench.heard().events[1].reason, Errc::kDeviceStatus);
    EXPECT_EQ(bench.heard().events[2].type, TiltEventType::kReady);
    EXPECT_EQ(bench.heard().events.size(), 3U);
    EXPECT_EQ(bench.session().counters().device_errors, 1U);
  }
}

TEST(DynamixelPing, OneOfAModelWithAnotherTableIsToldAndNothingIsWrittenToIt) {
  ServoBench bench(dynamixel_params());
  bench.to_session = [](std::vector<ServoFrame>& frames) {
    for (ServoFrame& frame : frames) {
      frame = dynamixel_frame(1, Instruction::kStatus, {0, 350 & 0xFF, 350 >> 8, 1});  // XL-320
    }
  };
  int requests = 0;
  bench.to_servo = [&](std::vector<ServoFrame>& frames) {
    requests += static_cast<int>(frames.size());
    for (const ServoFrame& frame : frames) {
      EXPECT_EQ(frame[7], static_cast<std::byte>(Instruction::kPing));
    }
  };
  bench.reset();
  bench.run(5 * kServoSecond);
  EXPECT_EQ(requests, 3) << "it is looked for every 2 s";
  ASSERT_EQ(bench.heard().count(TiltEventType::kDeviceError), 3);
  EXPECT_EQ(bench.heard().events[0].error, TiltError::kModel);
  EXPECT_EQ(bench.heard().events[0].code, 350);
  EXPECT_TRUE(bench.heard().has(TiltEventType::kLost, Errc::kWrongDevice));
  EXPECT_EQ(bench.heard().count(TiltEventType::kLost), 1);
}

// The memory that is kept takes writes only without torque, and wears.
TEST(DynamixelSettings, WhatDiffersAloneIsWrittenThoughTheServoHasTorque) {
  struct Setting {
    std::uint16_t address;
    DynamixelBytes other;
    std::uint32_t wished;
  };
  for (const Setting& setting :
       {Setting{dynamixel::kReturnDelay, {250}, 0}, Setting{dynamixel::kDriveMode, {dynamixel::kTimeBasedProfile}, 0},
        Setting{dynamixel::kOperatingMode, {1}, 3}, Setting{dynamixel::kPositionMax, {0xFF, 0x0F, 0, 0}, 2560},
        Setting{dynamixel::kPositionMin, {0, 0, 0, 0}, 1536}}) {
    SCOPED_TRACE(setting.address);
    ServoBench bench(dynamixel_params(), level_dynamixel());
    auto& device = bench.servo_as<DynamixelDevice>();
    bench.reset();
    bench.run(kServoSecond);
    const int before = device.kept_writes();
    for (const ServoFrame& frame :
         {dynamixel_write(dynamixel::kTorqueEnable, {0}), dynamixel_write(setting.address, setting.other),
          dynamixel_write(dynamixel::kTorqueEnable, {1})}) {
      device.receive(frame, bench.now_ns());
    }
    const int size = static_cast<int>(setting.other.size());
    ASSERT_NE(device.get(setting.address, size), setting.wished);
    bench.restart_session();
    bench.heard().events.clear();
    bench.reset();
    bench.run(kServoSecond);
    EXPECT_EQ(bench.session().state(), TiltState::kLevel);
    EXPECT_EQ(bench.heard().count(TiltEventType::kDeviceError), 0) << "nothing is refused";
    EXPECT_EQ(bench.heard().count(TiltEventType::kLost), 0);
    EXPECT_EQ(device.get(setting.address, size), setting.wished);
    EXPECT_EQ(device.kept_writes() - before, 2) << "somebody else's and its own";
  }
}

TEST(DynamixelStamps, AreThoseOfTheArrivalLessTheTimeOnTheLine) {
  for (const auto& [baud, line_ns] : {std::pair<int, std::int64_t>{57'600, 4'687'500}, {1'000'000, 270'000}, {0, 0}}) {
    TiltParams params = dynamixel_params();
    params.baud = baud;
    ServoBench bench(params, level_dynamixel(false, 8 * kServoMs));
    bench.reset();
    bench.run(2 * kServoSecond);
    ASSERT_GT(bench.heard().samples.size(), 50U);
    for (const TiltSample& sample : bench.heard().samples) {
      ASSERT_EQ(sample.arrival_ns - sample.stamp_ns, line_ns) << baud;
    }
  }
}

TEST(DynamixelEchoes, AreCountedOneForEachRequest) {
  ServoBench bench(dynamixel_params(), level_dynamixel(true));
  std::uint64_t requests = 0;
  bench.to_servo = [&](std::vector<ServoFrame>& frames) { requests += frames.size(); };
  bench.reset();
  bench.run(kServoSecond);
  EXPECT_NEAR(static_cast<double>(bench.session().counters().echoes), static_cast<double>(requests), 1.0);
}

}  // namespace
}  // namespace odoless
