// What the emulated drive answers and sends, as another master than ours sees it (CiA 301, CiA 402-2).
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "tests/support/times.hpp"
#include "tools/emulate/cia402_device.hpp"

namespace odoless {
namespace {

using canopen::NmtCommand;
using canopen::NodeState;
using canopen::Object;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

using test::kMs;

CanFrame frame_of(std::uint32_t id, std::initializer_list<int> data) {
  CanFrame made;
  made.id = id;
  for (const int byte : data) {
    made.data.at(made.size_bytes++) = static_cast<std::uint8_t>(byte);
  }
  return made;
}

class EmulatedDrive : public ::testing::Test {
 protected:
  EmulatedDrive() { static_cast<void>(heard()); }

  void say(const CanFrame& frame) { device_->receive(as_bytes(frame), now_ns_); }
  std::vector<CanFrame> heard() {
    std::vector<CanFrame> frames;
    for (const ServoFrame& bytes : device_->take_output()) {
      frames.push_back(*to_can_frame(bytes));
    }
    return frames;
  }
  std::vector<CanFrame> heard_from(std::uint32_t id) {
    std::vector<CanFrame> frames = heard();
    std::erase_if(frames, [&](const CanFrame& frame) { return frame.id != id; });
    return frames;
  }
  void run(std::int64_t duration_ns) {
    for (const std::int64_t end_ns = now_ns_ + duration_ns; now_ns_ < end_ns; now_ns_ += kMs) {
      device_->tick(now_ns_);
    }
  }
  std::vector<CanFrame> answer_to(const CanFrame& request) {
    static_cast<void>(heard());
    say(request);
    return heard_from(0x581);
  }
  /// 0, or the abort code.
  std::uint32_t write(Object object, std::uint32_t value, int size_bytes) {
    const std::vector<CanFrame> answers = answer_to(canopen::sdo_write(1, object, value, size_bytes));
    EXPECT_EQ(answers.size(), 1U);
    return answers.at(0).data[0] == 0x80 ? canopen::get(answers[0], 4, 4) : 0;
  }
  std::uint32_t read(Object object) {
    const std::vector<CanFrame> answers = answer_to(canopen::sdo_read(1, object));
    EXPECT_EQ(answers.size(), 1U);
    return canopen::get(answers.at(0), 4, 4);
  }
  /// The kinds and codes of emergency messages since the last question.
  std::vector<std::uint32_t> emergencies() {
    std::vector<std::uint32_t> codes;
    for (const CanFrame& frame : heard_from(0x081)) {
      codes.push_back(canopen::get(frame, 0, 2));
    }
    return codes;
  }
  void map_status_word(int type) {
    ASSERT_EQ(write({0x1800, 1}, 0x80000181U, 4), 0U);
    ASSERT_EQ(write({0x1A00, 0}, 0, 1), 0U);
    ASSERT_EQ(write({0x1A00, 1}, 0x60410010U, 4), 0U);
    ASSERT_EQ(write({0x1A00, 0}, 1, 1), 0U);
    ASSERT_EQ(write({0x1800, 2}, static_cast<std::uint32_t>(type), 1), 0U);
    ASSERT_EQ(write({0x1800, 1}, 0x40000181U, 4), 0U);
    say(canopen::nmt(NmtCommand::kStart, 1));
    run(5 * kMs);
    static_cast<void>(heard());
  }
  void enable() {
    for (const std::uint32_t control_word : {0x06U, 0x07U, 0x0FU}) {
      ASSERT_EQ(write({0x6040, 0}, control_word, 2), 0U);
    }
    ASSERT_EQ(device_->power(), cia402::PowerState::kEnabled);
  }
  void begin_anew(Cia402DeviceOptions options) {
    device_ = std::make_unique<Cia402Device>(std::move(options), now_ns_);
    static_cast<void>(heard());
  }

  std::int64_t now_ns_ = 1000 * 1000 * kMs;
  std::unique_ptr<Cia402Device> device_ = std::make_unique<Cia402Device>(Cia402DeviceOptions{}, now_ns_);
};

TEST_F(EmulatedDrive, SendsAPdoAtEveryNthSync) {
  for (const int type : {1, 2, 7, 240}) {
    SCOPED_TRACE(type);
    map_status_word(type);
    std::size_t sent = 0;
    for (int sync = 1; sync <= 3 * type; ++sync) {
      say(canopen::sync());
      sent += heard_from(0x181).size();
      ASSERT_EQ(sent, static_cast<std::size_t>(sync / type)) << "after SYNC " << sync;
    }
    say(canopen::nmt(NmtCommand::kPreOperational, 1));
  }
}

TEST_F(EmulatedDrive, SendsAnAcyclicPdoAtTheSyncAfterAChange) {
  map_status_word(0);
  say(canopen::sync());
  EXPECT_EQ(heard_from(0x181).size(), 1U) << "nothing of it was known before";
  say(canopen::sync());
  EXPECT_THAT(heard_from(0x181), IsEmpty());
  ASSERT_EQ(write({0x6040, 0}, 0x06, 2), 0U);
  run(5 * kMs);
  EXPECT_THAT(heard_from(0x181), IsEmpty());
  say(canopen::sync());
  EXPECT_EQ(heard_from(0x181).size(), 1U);
}

TEST_F(EmulatedDrive, SendsAnEventDrivenPdoAtAChangeAndAfterItsTimer) {
  map_status_word(0xFF);
  ASSERT_EQ(write({0x6040, 0}, 0x06, 2), 0U);
  run(3 * kMs);
  EXPECT_EQ(heard_from(0x181).size(), 1U);
  run(50 * kMs);
  EXPECT_THAT(heard_from(0x181), IsEmpty());
  say(canopen::sync());
  EXPECT_THAT(heard_from(0x181), IsEmpty());
  ASSERT_EQ(write({0x1800, 5}, 10, 2), 0U);
  run(100 * kMs);
  EXPECT_NEAR(static_cast<double>(heard_from(0x181).size()), 10.0, 1.0);
}

TEST_F(EmulatedDrive, ASynchronousReceivedPdoCountsAtTheNextSync) {
  ASSERT_EQ(write({0x1400, 1}, 0x80000201U, 4), 0U);
  ASSERT_EQ(write({0x1400, 2}, 1, 1), 0U);
  ASSERT_EQ(write({0x1400, 1}, 0x00000201U, 4), 0U);
  say(canopen::nmt(NmtCommand::kStart, 1));
  say(frame_of(0x201, {0x06, 0x00}));
  EXPECT_EQ(device_->power(), cia402::PowerState::kSwitchOnDisabled);
  say(canopen::sync());
  EXPECT_EQ(device_->power(), cia402::PowerState::kReady);
}

TEST_F(EmulatedDrive, AReceivedPdoThatIsTooShortIsNotTakenAndTold) {
  say(canopen::nmt(NmtCommand::kStart, 1));
  static_cast<void>(heard());
  say(frame_of(0x201, {0x06}));
  EXPECT_EQ(device_->power(), cia402::PowerState::kSwitchOnDisabled);
  EXPECT_THAT(emergencies(), ElementsAre(0x8210U));
}

TEST_F(EmulatedDrive, AValidPdoKeepsItsIdAndReservedTypesAreRefused) {
  EXPECT_EQ(write({0x1800, 1}, 0x00000182U, 4), 0x06090030U);
  EXPECT_EQ(read({0x1800, 1}) & 0x7FFU, 0x181U);
  EXPECT_EQ(write({0x1800, 1}, 0x80000182U, 4), 0U) << "together with its being made invalid it may change";
  EXPECT_EQ(write({0x1800, 1}, 0x00000182U, 4), 0U);
  EXPECT_EQ(write({0x1800, 2}, 241, 1), 0x06090030U);
  EXPECT_EQ(write({0x1801, 1}, 0x80000601U, 4), 0x06090030U) << "the id of SDO requests";
}

TEST_F(EmulatedDrive, TellsAMissingObjectFromAMissingSubIndex) {
  const auto abort_of = [&](Object object) {
    const CanFrame answer = answer_to(canopen::sdo_read(1, object)).at(0);
    EXPECT_EQ(answer.data[0], 0x80);
    return canopen::get(answer, 4, 4);
  };
  EXPECT_EQ(abort_of({0x1018, 9}), 0x06090011U);
  EXPECT_EQ(abort_of({0x6064, 1}), 0x06090011U);
  EXPECT_EQ(abort_of({0x2000, 0}), 0x06020000U);
  EXPECT_EQ(write({0x6064, 1}, 0, 4), 0x06090011U);
  EXPECT_EQ(write({0x2000, 0}, 0, 4), 0x06020000U);
}

TEST_F(EmulatedDrive, AnswersNeitherAbortsNorShortFrames) {
  EXPECT_THAT(answer_to(canopen::sdo_abort(1, {0x6064, 0}, 0x05040000U)), IsEmpty());
  EXPECT_THAT(answer_to(frame_of(0x601, {0x40, 0x64, 0x60, 0})), IsEmpty());
  EXPECT_THAT(answer_to(frame_of(0x601, {})), IsEmpty());
  EXPECT_EQ(answer_to(canopen::sdo_read(1, {0x6064, 0})).size(), 1U);
  EXPECT_EQ(answer_to(frame_of(0x601, {0xA0, 0x64, 0x60, 0, 0, 0, 0, 0})).at(0).data[0], 0x80)
      << "transfers by blocks are unknown";
}

TEST_F(EmulatedDrive, TakesASegmentedDownload) {
  const std::vector<CanFrame> begun = answer_to(frame_of(0x601, {0x21, 0x81, 0x60, 0, 4, 0, 0, 0}));
  ASSERT_EQ(begun.size(), 1U);
  EXPECT_EQ(begun[0].data[0], 0x60);
  const std::vector<CanFrame> ended = answer_to(frame_of(0x601, {0x07, 0x78, 0x56, 0x34, 0x12, 0, 0, 0}));
  ASSERT_EQ(ended.size(), 1U);
  EXPECT_EQ(ended[0].data[0], 0x20);
  EXPECT_EQ(read({0x6081, 0}), 0x12345678U);
  EXPECT_EQ(answer_to(frame_of(0x601, {0x07, 1, 0, 0, 0, 0, 0, 0})).at(0).data[0], 0x80) << "there is none";
}

TEST_F(EmulatedDrive, ASegmentedDownloadThatDoesNotFitChangesNothing) {
  const auto abort_of = [](const CanFrame& answer) {
    EXPECT_EQ(answer.data[0], 0x80);
    return canopen::get(answer, 4, 4);
  };
  const CanFrame begin = frame_of(0x601, {0x21, 0x81, 0x60, 0, 8, 0, 0, 0});
  EXPECT_EQ(answer_to(begin).at(0).data[0], 0x60);
  EXPECT_EQ(answer_to(frame_of(0x601, {0x00, 1, 2, 3, 4, 5, 6, 7})).at(0).data[0], 0x20);
  EXPECT_EQ(abort_of(answer_to(frame_of(0x601, {0x1D, 8, 0, 0, 0, 0, 0, 0})).at(0)), 0x06070012U);
  EXPECT_EQ(answer_to(begin).at(0).data[0], 0x60);
  EXPECT_EQ(abort_of(answer_to(frame_of(0x601, {0x10, 1, 2, 3, 4, 5, 6, 7})).at(0)), 0x05030000U);
  EXPECT_EQ(read({0x6081, 0}), 10'000U);
}

TEST_F(EmulatedDrive, TellsItsNameBySegments) {
  const CanFrame begun = answer_to(canopen::sdo_read(1, {0x1008, 0})).at(0);
  EXPECT_EQ(begun.data[0], 0x41);
  std::string name;
  for (int toggle = 0;; toggle ^= 0x10) {
    const CanFrame segment = answer_to(frame_of(0x601, {0x60 | toggle, 0, 0, 0, 0, 0, 0, 0})).at(0);
    ASSERT_EQ(segment.data[0] & 0xF0, toggle);
    const int count = 7 - (segment.data[0] >> 1 & 7);
    name.append(reinterpret_cast<const char*>(segment.data.data()) + 1, static_cast<std::size_t>(count));
    if ((segment.data[0] & 1) != 0) {
      break;
    }
  }
  EXPECT_EQ(name, "odoless emulated drive");
  EXPECT_EQ(name.size(), canopen::get(begun, 4, 4));
}

TEST_F(EmulatedDrive, TellsThatAnErrorHasComeAndGone) {
  begin_anew({.faults = {parse_fault("error=8976@0:0.1")}});  // 2310h: current
  run(2 * kMs);
  say(canopen::sync());
  run(5 * kMs);
  std::vector<CanFrame> messages = heard_from(0x081);
  ASSERT_EQ(messages.size(), 1U);
  EXPECT_EQ(canopen::get(messages[0], 0, 2), 0x2310U);
  EXPECT_EQ(messages[0].data[2], 0x03) << "something, and the current";
  EXPECT_EQ(read({0x1001, 0}), 0x03U);
  EXPECT_EQ(read({0x1003, 0}), 1U);
  EXPECT_EQ(read({0x1003, 1}), 0x2310U);
  run(200 * kMs);
  ASSERT_EQ(write({0x6040, 0}, 0x00, 2), 0U);
  static_cast<void>(heard());
  say(canopen::sdo_write(1, {0x6040, 0}, 0x80, 2));
  EXPECT_THAT(emergencies(), ElementsAre(0U));
  EXPECT_EQ(read({0x1001, 0}), 0U);
  EXPECT_EQ(read({0x603F, 0}), 0U);
  EXPECT_EQ(read({0x1003, 0}), 1U) << "a history stays";
  EXPECT_EQ(write({0x1003, 0}, 1, 1), 0x06090030U);
  EXPECT_EQ(write({0x1003, 0}, 0, 1), 0U);
  EXPECT_EQ(read({0x1003, 0}), 0U);
}

TEST_F(EmulatedDrive, LeavesTheOperationalStateWhenItsMasterIsLost) {
  for (const auto& [behaviour, state] : {std::pair(0U, NodeState::kPreOperational),
                                         std::pair(1U, NodeState::kOperational), std::pair(2U, NodeState::kStopped)}) {
    SCOPED_TRACE(behaviour);
    begin_anew({});
    ASSERT_EQ(write({0x1029, 1}, behaviour, 1), 0U);
    ASSERT_EQ(write({0x6007, 0}, 3, 2), 0U);
    ASSERT_EQ(write({0x1016, 1}, 127U << 16U | 100U, 4), 0U);
    say(canopen::nmt(NmtCommand::kStart, 1));
    enable();
    say(canopen::heartbeat(127, NodeState::kOperational));
    run(90 * kMs);
    EXPECT_EQ(device_->node_state(), NodeState::kOperational);
    static_cast<void>(heard());
    run(30 * kMs);
    EXPECT_EQ(device_->node_state(), state);
    EXPECT_THAT(emergencies(), ElementsAre(0x8130U));
    say(canopen::heartbeat(127, NodeState::kOperational));
    EXPECT_THAT(emergencies(), ElementsAre(0U));
  }
}

TEST_F(EmulatedDrive, DoesWhatTheAbortConnectionOptionSays) {
  using cia402::PowerState;
  for (const auto& [option, power] : {std::pair(0U, PowerState::kEnabled), std::pair(1U, PowerState::kFault),
                                      std::pair(2U, PowerState::kSwitchOnDisabled)}) {
    begin_anew({});
    ASSERT_EQ(write({0x6007, 0}, option, 2), 0U);
    ASSERT_EQ(write({0x1016, 1}, 127U << 16U | 100U, 4), 0U);
    enable();
    say(canopen::heartbeat(127, NodeState::kOperational));
    run(150 * kMs);
    EXPECT_EQ(device_->power(), power) << option;
  }
}

TEST_F(EmulatedDrive, SaysWhichModesItHasAndTakesNoOther) {
  EXPECT_EQ(read({0x6502, 0}), 0xA1U) << "profile position, homing, cyclic synchronous position";
  EXPECT_EQ(write({0x6060, 0}, 100, 1), 0x06090030U);
  EXPECT_EQ(write({0x6060, 0}, 3, 1), 0x06090030U);
  for (const std::uint32_t mode : {8U, 6U}) {
    EXPECT_EQ(write({0x6060, 0}, mode, 1), 0U);
    EXPECT_EQ(read({0x6061, 0}), mode);
  }
  EXPECT_EQ(write({0x605A, 0}, 4, 2), 0x06090030U);
}

TEST_F(EmulatedDrive, SendsEmergenciesWhereItIsToldAndNotWhenItIsNot) {
  EXPECT_EQ(read({0x1014, 0}), 0x81U);
  EXPECT_EQ(write({0x1014, 0}, 0x82U, 4), 0x06090030U) << "in use";
  EXPECT_EQ(write({0x1014, 0}, 0x80000081U, 4), 0U);
  say(canopen::nmt(NmtCommand::kStart, 1));
  static_cast<void>(heard());
  say(frame_of(0x201, {0x06}));
  EXPECT_THAT(emergencies(), IsEmpty());
  EXPECT_EQ(read({0x1001, 0}), 0x11U);
}

}  // namespace
}  // namespace odoless
