#include "drivers/tilt/cia402/canopen.hpp"

#include <gtest/gtest.h>

#include "core/base/rng.hpp"
#include "drivers/tilt/cia402/sdo_client.hpp"
#include "tests/support/times.hpp"

namespace odoless::canopen {
namespace {

using test::kMs;

CanFrame frame(std::uint32_t id, std::initializer_list<std::uint8_t> data) {
  CanFrame made;
  made.id = id;
  made.size_bytes = static_cast<std::uint8_t>(data.size());
  std::copy(data.begin(), data.end(), made.data.begin());
  return made;
}

// Bytes as CiA 301 has them.
TEST(CanOpen, FramesAreAsInTheStandard) {
  EXPECT_EQ(nmt(NmtCommand::kStart, 5), frame(0x000, {0x01, 0x05}));
  EXPECT_EQ(nmt(NmtCommand::kPreOperational, 0), frame(0x000, {0x80, 0x00}));
  EXPECT_EQ(nmt(NmtCommand::kResetCommunication, 7), frame(0x000, {0x82, 0x07}));
  EXPECT_EQ(sync(), frame(0x080, {}));
  EXPECT_EQ(heartbeat(127, NodeState::kOperational), frame(0x77F, {0x05}));
  EXPECT_EQ(sdo_write(1, {0x6060, 0}, 1, 1), frame(0x601, {0x2F, 0x60, 0x60, 0x00, 0x01, 0, 0, 0}));
  EXPECT_EQ(sdo_write(1, {0x6040, 0}, 0x000F, 2), frame(0x601, {0x2B, 0x40, 0x60, 0x00, 0x0F, 0x00, 0, 0}));
  EXPECT_EQ(sdo_write(3, {0x1A00, 1}, 0x60410010, 4), frame(0x603, {0x23, 0x00, 0x1A, 0x01, 0x10, 0x00, 0x41, 0x60}));
  EXPECT_EQ(sdo_read(2, {0x1018, 4}), frame(0x602, {0x40, 0x18, 0x10, 0x04, 0, 0, 0, 0}));
  EXPECT_EQ(sdo_abort(2, {0x1018, 4}, kAbortTimedOut), frame(0x602, {0x80, 0x18, 0x10, 0x04, 0, 0, 0x04, 0x05}));
}

TEST(CanOpen, RepliesAreDecoded) {
  const auto value = sdo_reply(frame(0x581, {0x4B, 0x41, 0x60, 0x00, 0x37, 0x02, 0xAA, 0xBB}));
  ASSERT_TRUE(value.ok());
  EXPECT_EQ(value.value().kind, SdoReply::Kind::kValue);
  EXPECT_EQ(value.value().object, (Object{0x6041, 0}));
  EXPECT_EQ(value.value().value, 0x0237U) << "bytes that aren't used don't count";
  EXPECT_EQ(value.value().size_bytes, 2);
  EXPECT_EQ(sdo_reply(frame(0x581, {0x43, 0, 0x10, 0, 0x92, 0x01, 0x02, 0x00})).value().value, 0x00020192U);
  EXPECT_EQ(sdo_reply(frame(0x581, {0x60, 0x40, 0x60, 0, 0, 0, 0, 0})).value().kind, SdoReply::Kind::kWritten);
  const auto abort = sdo_reply(frame(0x581, {0x80, 0x40, 0x60, 0, 0x00, 0x00, 0x02, 0x06}));
  EXPECT_EQ(abort.value().kind, SdoReply::Kind::kAbort);
  EXPECT_EQ(abort.value().value, 0x06020000U);
  const auto emergency_frame = frame(0x081, {0x30, 0x81, 0x11, 0, 0, 0, 0, 0});
  EXPECT_EQ(emergency(emergency_frame).value().code, 0x8130);
  EXPECT_EQ(emergency(emergency_frame).value().error_register, 0x11);
  EXPECT_EQ(heartbeat_state(frame(0x701, {0x7F})).value(), NodeState::kPreOperational);
}

TEST(CanOpen, WhatIsNotWholeIsRefused) {
  EXPECT_EQ(sdo_reply(frame(0x581, {0x60, 0x40, 0x60, 0, 0, 0, 0})).error(), Errc::kFrameMalformed);
  EXPECT_EQ(sdo_reply(frame(0x581, {0x41, 0x08, 0x10, 0, 5, 0, 0, 0})).error(), Errc::kFrameMalformed) << "segmented";
  EXPECT_EQ(emergency(frame(0x081, {0x30, 0x81})).error(), Errc::kFrameMalformed);
  EXPECT_EQ(heartbeat_state(frame(0x701, {})).error(), Errc::kFrameMalformed);
  EXPECT_EQ(heartbeat_state(frame(0x701, {0x33})).error(), Errc::kFrameMalformed);
}

TEST(CanOpen, NumbersGoInAndOutLittleEndianWhereverTheyStand) {
  Rng rng(5);
  for (int i = 0; i < 1000; ++i) {
    CanFrame holder;
    const std::uint32_t value = rng.next();
    const int size = 1 + static_cast<int>(rng.below(4));
    const int at = static_cast<int>(rng.below(static_cast<std::uint32_t>(9 - size)));
    put(holder, at, value, size);
    EXPECT_EQ(get(holder, at, size), size == 4 ? value : value & ((1U << (8 * size)) - 1U));
    EXPECT_EQ(holder.data[static_cast<std::size_t>(at)], value & 0xFFU);
  }
}

TEST(CanFrame, OnlyWholeFramesAreTaken) {
  const CanFrame made = frame(0x181, {1, 2, 3});
  EXPECT_EQ(to_can_frame(as_bytes(made)), made);
  EXPECT_FALSE(to_can_frame(as_bytes(made).first(15)));
  CanFrame long_one = made;
  long_one.size_bytes = 9;
  EXPECT_FALSE(to_can_frame(as_bytes(long_one)));
}

class SdoClientTest : public ::testing::Test {
 protected:
  SdoClient client_{1, 50 * kMs};

  SdoClient::Outcome reply(std::initializer_list<std::uint8_t> data) {
    return client_.on_reply(sdo_reply(frame(0x581, data)).value());
  }
};

TEST_F(SdoClientTest, ReadsAndWrites) {
  EXPECT_FALSE(client_.take_request());
  client_.read({0x6041, 0}, 0);
  EXPECT_EQ(client_.take_request(), sdo_read(1, {0x6041, 0}));
  EXPECT_FALSE(client_.take_request()) << "once";
  EXPECT_EQ(reply({0x4B, 0x41, 0x60, 0, 0x50, 0x02, 0, 0}), SdoClient::Outcome::kDone);
  EXPECT_EQ(client_.value(), 0x0250U);
  client_.write({0x6060, 0}, 1, 1, 0);
  EXPECT_EQ(client_.take_request(), sdo_write(1, {0x6060, 0}, 1, 1));
  EXPECT_EQ(reply({0x60, 0x60, 0x60, 0, 0, 0, 0, 0}), SdoClient::Outcome::kDone);
  EXPECT_FALSE(client_.busy());
}

TEST_F(SdoClientTest, TakesNoAnswerToSomethingElse) {
  client_.read({0x6041, 0}, 0);
  EXPECT_EQ(reply({0x4B, 0x61, 0x60, 0, 1, 0, 0, 0}), SdoClient::Outcome::kPending) << "another object";
  EXPECT_EQ(reply({0x60, 0x41, 0x60, 0, 0, 0, 0, 0}), SdoClient::Outcome::kPending) << "it was not written";
  EXPECT_EQ(reply({0x80, 0x61, 0x60, 0, 0, 0, 2, 6}), SdoClient::Outcome::kPending) << "another one's abort";
  EXPECT_EQ(reply({0x80, 0x41, 0x60, 0, 0, 0, 2, 6}), SdoClient::Outcome::kAborted);
  EXPECT_EQ(client_.value(), 0x06020000U);
  EXPECT_EQ(reply({0x4B, 0x41, 0x60, 0, 1, 0, 0, 0}), SdoClient::Outcome::kPending) << "nothing is asked any more";
}

TEST_F(SdoClientTest, AsksThreeTimesAndGivesUp) {
  client_.write({0x6060, 0}, 1, 1, 0);
  for (int i = 1; i <= 2; ++i) {
    EXPECT_TRUE(client_.take_request());
    EXPECT_EQ(client_.deadline_ns(), i * 50 * kMs);
    EXPECT_EQ(client_.on_deadline(client_.deadline_ns()), SdoClient::Outcome::kPending);
  }
  EXPECT_TRUE(client_.take_request());
  EXPECT_EQ(client_.on_deadline(client_.deadline_ns()), SdoClient::Outcome::kTimedOut);
  EXPECT_FALSE(client_.take_request());
}

}  // namespace
}  // namespace odoless::canopen
