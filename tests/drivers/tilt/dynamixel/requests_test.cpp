// When a session asks a Dynamixel for something, and what it does when it is not answered.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
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

/// A request, or an answer, and when it was sent.
struct SentPacket {
  std::int64_t at_ns = 0;
  int instruction = 0;
  int address = 0;  ///< of a read or write
};

SentPacket sent_packet(const ServoFrame& frame, std::int64_t now_ns) {
  const auto at = [&](std::size_t i) { return i < frame.size() ? std::to_integer<int>(frame[i]) : 0; };
  return {.at_ns = now_ns, .instruction = at(7), .address = at(8) + 256 * at(9)};
}

/// A servo that sweeps and was asked long enough for everything to be as always, and what it is asked from then on.
class DynamixelRequests : public ::testing::Test {
 protected:
  DynamixelRequests() : bench_(params()) {}

  static TiltParams params() {
    TiltParams params = test::servo_params(TiltDriver::kDynamixel);
    params.at_start = TiltCommand::kSweep;
    return params;
  }

  void SetUp() override {
    bench_.reset();
    ASSERT_GT(bench_.run_until(TiltState::kSweeping, 3 * kServoSecond), 0);
    bench_.run(kServoSecond);
    bench_.to_servo = [this](std::vector<ServoFrame>& frames) {
      for (const ServoFrame& frame : frames) {
        requests_.push_back(sent_packet(frame, bench_.now_ns()));
      }
    };
  }

  /// Until nothing is asked, and nothing is due for 3 ms.
  void run_until_idle() {
    const auto is_idle = [this] {
      const std::int64_t left_ns = bench_.session().next_deadline_ns() - bench_.now_ns();
      return left_ns > 3 * kServoMs && left_ns < params().sample_period_ns;
    };
    ASSERT_GE(bench_.run_until(is_idle, 100 * kServoMs), 0);
    requests_.clear();
  }
  void expect_goal_at_once() {
    const std::int64_t told_ns = bench_.now_ns();
    bench_.run(kServoMs / 2);
    ASSERT_FALSE(requests_.empty());
    EXPECT_EQ(requests_[0].at_ns, told_ns);
    EXPECT_EQ(requests_[0].instruction, static_cast<int>(Instruction::kWrite));
    EXPECT_EQ(requests_[0].address, dynamixel::kProfile);
  }

  ServoBench bench_;
  std::vector<SentPacket> requests_;
};

TEST_F(DynamixelRequests, AStopIsSentAtOnceWhereTheLineIsFree) {
  run_until_idle();
  bench_.command(TiltCommand::kStop);
  expect_goal_at_once();
}

TEST_F(DynamixelRequests, AnEndIsSentAtOnceWhereTheLineIsFree) {
  run_until_idle();
  bench_.session().finish(TiltEnd::kHold, bench_.now_ns());
  expect_goal_at_once();
}

TEST_F(DynamixelRequests, ALostAnswerToAGoalIsAskedForAgainAfterItsTime) {
  run_until_idle();
  bench_.to_session = [](std::vector<ServoFrame>& frames) { frames.clear(); };
  bench_.command(TiltCommand::kStop);
  bench_.run(params().reply_timeout_ns + kServoMs / 4);
  bench_.to_session = [](std::vector<ServoFrame>&) {};
  ASSERT_GE(requests_.size(), 2U);
  EXPECT_NEAR(static_cast<double>(requests_[1].at_ns - requests_[0].at_ns),
              static_cast<double>(params().reply_timeout_ns), 0.5 * kServoMs);
  EXPECT_EQ(requests_[1].address, dynamixel::kProfile);
  bench_.run(kServoSecond);
  EXPECT_EQ(bench_.session().state(), TiltState::kStopped);
  EXPECT_EQ(bench_.session().counters().timeouts, 1U);
  EXPECT_EQ(bench_.heard().count(TiltEventType::kLost), 0);
}

TEST_F(DynamixelRequests, OneIsSentAtATimeAndAnglesAreAskedForEvenly) {
  int unanswered = 0;
  bench_.to_servo = [&](std::vector<ServoFrame>& frames) {
    for (const ServoFrame& frame : frames) {
      EXPECT_EQ(unanswered++, 0) << "two on a half-duplex line at once are heard by nobody";
      requests_.push_back(sent_packet(frame, bench_.now_ns()));
    }
  };
  bench_.to_session = [&](std::vector<ServoFrame>& frames) { unanswered -= static_cast<int>(frames.size()); };
  run_until_idle();
  bench_.run(2 * kServoSecond);
  std::erase_if(requests_, [](const SentPacket& request) { return request.address != dynamixel::kMotionFirst; });
  EXPECT_NEAR(static_cast<double>(requests_.size()), 200.0, 2.0);
  for (std::size_t i = 1; i < requests_.size(); ++i) {
    const std::int64_t since_ns = requests_[i].at_ns - requests_[i - 1].at_ns;
    EXPECT_NEAR(static_cast<double>(since_ns), static_cast<double>(params().sample_period_ns), 2.0 * kServoMs);
  }
}

TEST_F(DynamixelRequests, AHostThatIsLateAsksNotInABundle) {
  run_until_idle();
  bench_.host_asleep = true;
  bench_.run(120 * kServoMs);
  bench_.host_asleep = false;
  requests_.clear();
  bench_.run(30 * kServoMs);
  EXPECT_LE(std::ranges::count(requests_, dynamixel::kMotionFirst, &SentPacket::address), 5);
  EXPECT_EQ(bench_.heard().count(TiltEventType::kLost), 0);
}

TEST_F(DynamixelRequests, WhatWasHalfReceivedIsForgottenWhenTheLineIsOpenedAnew) {
  const std::vector<std::uint8_t> data(20, 0);
  const dynamixel::PacketBytes packet = dynamixel::encode(1, Instruction::kStatus, data);
  const auto half = std::as_bytes(packet.span()).first(14);
  run_until_idle();
  bench_.session().receive(half, bench_.now_ns(), bench_.heard());
  const std::size_t events = bench_.heard().events.size();
  const std::uint64_t timeouts = bench_.session().counters().timeouts;
  bench_.reset();
  bench_.run(kServoSecond);
  ASSERT_EQ(bench_.heard().events.size(), events + 1);
  EXPECT_EQ(bench_.heard().events.back().type, TiltEventType::kReady);
  EXPECT_EQ(bench_.session().counters().timeouts, timeouts);
}

TEST_F(DynamixelRequests, ARefusedPingIsToldWithoutAnAddress) {
  run_until_idle();
  bool is_refused = false;
  bench_.to_session = [&](std::vector<ServoFrame>& frames) {
    for (ServoFrame& frame : frames) {
      if (!std::exchange(is_refused, true)) {
        const std::vector<std::uint8_t> error{2};
        const dynamixel::PacketBytes packet = dynamixel::encode(1, Instruction::kStatus, error);
        frame.assign(std::as_bytes(packet.span()).begin(), std::as_bytes(packet.span()).end());
      }
    }
  };
  bench_.reset();
  bench_.run(kServoSecond);
  const auto told = std::ranges::find(bench_.heard().events, TiltEventType::kDeviceError, &TiltEvent::type);
  ASSERT_NE(told, bench_.heard().events.end());
  EXPECT_EQ(told->code, 2);
  EXPECT_EQ(told->object, 0U);
  EXPECT_EQ(bench_.session().state(), TiltState::kSweeping);
}

}  // namespace
}  // namespace odoless
