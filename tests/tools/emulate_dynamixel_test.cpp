// What the emulated Dynamixel answers, as another client than ours asks it (e-Manual of Protocol 2.0, of the
// XM430-W350).
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <optional>
#include <vector>

#include "tests/support/times.hpp"
#include "tools/emulate/dynamixel_device.hpp"

namespace odoless {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;

using test::kMs;
constexpr int kAll = 0xFE;

using Bytes = std::vector<std::uint8_t>;

class EmulatedDynamixel : public ::testing::Test {
 protected:
  void say(int id, int instruction, const Bytes& parameters) {
    const dynamixel::PacketBytes packet =
        dynamixel::encode(id, static_cast<dynamixel::Instruction>(instruction), parameters);
    device_.receive(std::as_bytes(packet.span()), now_ns_);
  }
  void run(std::int64_t duration_ns) {
    for (const std::int64_t end_ns = now_ns_ + duration_ns; now_ns_ < end_ns; now_ns_ += kMs) {
      device_.tick(now_ns_);
    }
  }
  /// Every status packet since the last question.
  std::vector<dynamixel::Packet> heard() {
    run(5 * kMs);
    std::vector<dynamixel::Packet> packets;
    for (const ServoFrame& frame : device_.take_output()) {
      std::span<const std::byte> bytes = frame;
      for (auto outcome = reader_.take(bytes); outcome != dynamixel::PacketReader::Outcome::kMore;
           outcome = reader_.take(bytes)) {
        EXPECT_EQ(outcome, dynamixel::PacketReader::Outcome::kPacket);
        packets.push_back(reader_.packet());
      }
    }
    return packets;
  }
  std::optional<dynamixel::Packet> answer(int id, int instruction, const Bytes& parameters) {
    static_cast<void>(heard());
    say(id, instruction, parameters);
    const std::vector<dynamixel::Packet> packets = heard();
    EXPECT_LE(packets.size(), 1U);
    return packets.empty() ? std::nullopt : std::optional(packets[0]);
  }
  /// The error of an answer, or -1: there is none.
  int error_of(int id, int instruction, const Bytes& parameters) {
    const auto packet = answer(id, instruction, parameters);
    return packet ? packet->error() : -1;
  }
  static Bytes address_and(int address, const Bytes& data) {
    Bytes all;
    all.push_back(static_cast<std::uint8_t>(address & 0xFF));
    all.push_back(static_cast<std::uint8_t>(address >> 8));
    for (const std::uint8_t byte : data) {
      all.push_back(byte);
    }
    return all;
  }
  int write(int address, const Bytes& data, int id = 1) { return error_of(id, 0x03, address_and(address, data)); }
  std::uint32_t read(int address, int size_bytes) {
    const auto packet = answer(1, 0x02, address_and(address, {static_cast<std::uint8_t>(size_bytes), 0}));
    EXPECT_TRUE(packet && packet->error() == 0);
    return packet ? packet->get(0, static_cast<std::size_t>(size_bytes)) : 0;
  }
  static Bytes data_of(const dynamixel::Packet& packet) {
    return {packet.parameters.begin() + 1, packet.parameters.begin() + static_cast<std::ptrdiff_t>(packet.size)};
  }
  /// Position control with torque.
  void enable() {
    ASSERT_EQ(write(11, {3}), 0);
    ASSERT_EQ(write(64, {1}), 0);
  }
  static Bytes number(std::int32_t value) {
    const auto bits = static_cast<std::uint32_t>(value);
    return {static_cast<std::uint8_t>(bits), static_cast<std::uint8_t>(bits >> 8U),
            static_cast<std::uint8_t>(bits >> 16U), static_cast<std::uint8_t>(bits >> 24U)};
  }

  static DynamixelDeviceOptions at_centre() {
    DynamixelDeviceOptions options;
    options.start_rad = 0.0;
    return options;
  }

  std::int64_t now_ns_ = 1000 * 1000 * kMs;
  DynamixelDevice device_{at_centre(), now_ns_};
  dynamixel::PacketReader reader_;
};

TEST_F(EmulatedDynamixel, AnswersABroadcastPing) {
  const auto packet = answer(kAll, 0x01, {});
  ASSERT_TRUE(packet);
  EXPECT_EQ(packet->id, 1);
  EXPECT_THAT(data_of(*packet), ElementsAre(1020 & 0xFF, 1020 >> 8, 45));
}

TEST_F(EmulatedDynamixel, GivesTheErrorNumbersOfTheManual) {
  EXPECT_EQ(write(120, {0, 0}), 7) << "read only";
  EXPECT_EQ(write(132, number(0)), 7) << "read only";
  EXPECT_EQ(write(0, {1, 1}), 7) << "read only";
  EXPECT_EQ(write(400, {1}), 7) << "there is no such address";
  EXPECT_EQ(write(150, {1}), 7) << "there is no such address";
  EXPECT_EQ(error_of(1, 0x02, {0x90, 0x01, 4, 0}), 7) << "nor to be read";
  EXPECT_EQ(write(64, {7}), 4) << "torque is 0 or 1";
  EXPECT_EQ(write(11, {99}), 4) << "no operating mode";
  EXPECT_EQ(write(11, {2}), 4) << "no operating mode";
  EXPECT_EQ(write(7, {253}), 4) << "no id";
  EXPECT_EQ(write(8, {8}), 4) << "no rate";
  EXPECT_EQ(write(48, number(4096)), 4);
  EXPECT_EQ(write(98, {128}), 4);
  EXPECT_EQ(write(116, {0, 8}), 5) << "half a goal";
  EXPECT_EQ(error_of(1, 0x03, {64, 0}), 5) << "nothing to write";
  EXPECT_EQ(error_of(1, 0x02, {64, 0}), 5);
  EXPECT_EQ(error_of(1, 0x77, {}), 2);
  enable();
  EXPECT_EQ(write(11, {3}), 7) << "kept, and the torque is on";
  EXPECT_EQ(write(116, number(4096)), 6) << "beyond the position limit";
  EXPECT_EQ(write(104, number(201)), 6) << "beyond the velocity limit";
  EXPECT_EQ(write(104, number(-200)), 0);
}

TEST_F(EmulatedDynamixel, ItsTableHasWhatAnXm430Has) {
  EXPECT_EQ(read(144, 2), 120U) << "12.0 V";
  EXPECT_NEAR(static_cast<double>(read(146, 1)), 30.0, 10.0) << "deg C";
  EXPECT_EQ(read(84, 2), 800U);
  EXPECT_EQ(read(76, 2), 1920U);
  EXPECT_EQ(read(78, 2), 100U);
  EXPECT_EQ(read(31, 1), 80U);
  EXPECT_EQ(read(32, 2), 160U);
  EXPECT_EQ(read(34, 2), 95U);
  EXPECT_EQ(read(36, 2), 885U);
  EXPECT_EQ(read(38, 2), 1193U);
  EXPECT_EQ(read(44, 4), 200U);
  EXPECT_EQ(read(48, 4), 4095U);
  EXPECT_EQ(read(9, 1), 250U);
  EXPECT_EQ(read(13, 1), 2U);
  EXPECT_EQ(read(12, 1), 255U);
}

TEST_F(EmulatedDynamixel, ObeysToItsNewIdAndAnswersTheChangeAsTheOld) {
  EXPECT_EQ(write(7, {9}), 0);
  EXPECT_EQ(error_of(1, 0x01, {}), -1);
  const auto packet = answer(9, 0x01, {});
  ASSERT_TRUE(packet);
  EXPECT_EQ(packet->id, 9);
  EXPECT_EQ(error_of(9, 0x08, {}), 0);
  run(500 * kMs);
  EXPECT_EQ(error_of(9, 0x01, {}), 0) << "it is kept";
}

TEST_F(EmulatedDynamixel, HearsOnlyWhatComesAtItsRate) {
  device_.set_line_baud(57'600);
  EXPECT_EQ(error_of(1, 0x01, {}), 0);
  EXPECT_EQ(write(8, {3}), 0) << "answered at the rate that it came at";
  EXPECT_EQ(error_of(1, 0x01, {}), -1);
  device_.set_line_baud(1'000'000);
  EXPECT_EQ(error_of(1, 0x01, {}), 0);
  device_.set_line_baud(38'400);
  EXPECT_EQ(error_of(1, 0x01, {}), 0) << "a terminal that nobody has set";
}

TEST_F(EmulatedDynamixel, DoesAWriteThatWasRegisteredWhenItIsTold) {
  enable();
  EXPECT_EQ(error_of(1, 0x04, address_and(116, number(2200))), 0);
  EXPECT_EQ(read(69, 1), 1U);
  run(200 * kMs);
  EXPECT_EQ(read(132, 4), 2048U);
  EXPECT_EQ(error_of(1, 0x04, address_and(116, number(5000))), 6);
  EXPECT_EQ(error_of(1, 0x04, address_and(120, {0, 0})), 7);
  say(kAll, 0x05, {});
  EXPECT_THAT(heard(), IsEmpty()) << "to all: nobody answers";
  EXPECT_EQ(read(69, 1), 0U);
  run(500 * kMs);
  EXPECT_EQ(read(132, 4), 2200U);
  EXPECT_EQ(error_of(1, 0x05, {}), 0);
}

TEST_F(EmulatedDynamixel, IsReadTogetherWithOthers) {
  const auto sync = answer(kAll, 0x82, {132, 0, 4, 0, 1});
  ASSERT_TRUE(sync);
  EXPECT_EQ(sync->id, 1);
  EXPECT_THAT(data_of(*sync), ElementsAre(0, 8, 0, 0));
  EXPECT_EQ(error_of(kAll, 0x82, {132, 0, 4, 0, 5, 1, 7}), 0) << "the others aren't there";
  EXPECT_EQ(error_of(kAll, 0x82, {132, 0, 4, 0, 5, 7}), -1) << "not asked";
  const auto bulk = answer(kAll, 0x92, {3, 132, 0, 4, 0, 1, 144, 0, 2, 0});
  ASSERT_TRUE(bulk);
  EXPECT_THAT(data_of(*bulk), ElementsAre(120, 0));
  EXPECT_EQ(error_of(1, 0x82, {132, 0, 4, 0, 1}), 2) << "is for all";
}

TEST_F(EmulatedDynamixel, IsReadFast) {
  for (const Bytes& parameters : {Bytes{132, 0, 4, 0, 1}, Bytes{1, 132, 0, 4, 0}}) {
    const auto packet = answer(kAll, parameters[0] == 1 ? 0x9A : 0x8A, parameters);
    ASSERT_TRUE(packet);
    EXPECT_EQ(packet->id, kAll);
    EXPECT_EQ(packet->error(), 0);
    EXPECT_THAT(data_of(*packet), ElementsAre(1, 0, 8, 0, 0)) << "id and data";
  }
  say(kAll, 0x8A, {132, 0, 4, 0, 1, 2});
  run(5 * kMs);
  const std::vector<ServoFrame> frames = device_.take_output();
  ASSERT_THAT(frames, SizeIs(1));
  EXPECT_EQ(static_cast<int>(frames[0][5]), 1 + 2 * 8) << "the length of both servos' parts";
  EXPECT_THAT(frames[0], SizeIs(8 + 8)) << "and its own part";
  EXPECT_EQ(error_of(kAll, 0x8A, {132, 0, 4, 0, 2, 1}), -1) << "the first, who begins the packet, isn't there";
}

TEST_F(EmulatedDynamixel, IsWrittenTogetherWithOthersWithoutAnAnswer) {
  enable();
  say(kAll, 0x83, {116, 0, 4, 0, 7, 0, 9, 0, 0, 1, 0, 7, 0, 0});
  EXPECT_THAT(heard(), IsEmpty());
  run(500 * kMs);
  EXPECT_EQ(read(132, 4), 0x700U);
  say(kAll, 0x93, {7, 65, 0, 1, 0, 1, 1, 116, 0, 4, 0, 0, 9, 0, 0});
  EXPECT_THAT(heard(), IsEmpty());
  run(500 * kMs);
  EXPECT_EQ(read(132, 4), 0x900U);
  say(kAll, 0x03, address_and(65, {1}));
  EXPECT_THAT(heard(), IsEmpty());
  EXPECT_EQ(read(65, 1), 1U);
  say(kAll, 0x02, {65, 0, 1, 0});
  EXPECT_THAT(heard(), IsEmpty()) << "who of all should answer?";
}

TEST_F(EmulatedDynamixel, ClearsTheTurnsThatItHasMade) {
  ASSERT_EQ(write(11, {4}), 0);
  ASSERT_EQ(write(64, {1}), 0);
  EXPECT_EQ(write(116, number(3 * 4096 + 100)), 0);
  run(3000 * kMs);
  EXPECT_EQ(read(132, 4), 3U * 4096 + 100);
  EXPECT_EQ(error_of(1, 0x10, {1, 0x44, 0x58, 0x4C, 0x22}), 0);
  EXPECT_EQ(read(132, 4), 100U);
  EXPECT_EQ(error_of(1, 0x10, {1, 0, 0, 0, 0}), 4);
}

TEST_F(EmulatedDynamixel, IsAsFromTheFactoryAfterAReset) {
  ASSERT_EQ(write(7, {4}), 0);
  ASSERT_EQ(write(8, {3}, 4), 0);
  ASSERT_EQ(write(48, number(3000), 4), 0);
  say(kAll, 0x06, {0xFF});
  EXPECT_THAT(heard(), IsEmpty());
  EXPECT_EQ(error_of(4, 0x01, {}), 0) << "for all at once, that would give every servo one id";
  EXPECT_EQ(error_of(4, 0x06, {0x02}), 0);
  run(500 * kMs);
  EXPECT_EQ(error_of(4, 0x01, {}), 0);
  EXPECT_EQ(device_.get(48, 4), 4095U);
  EXPECT_EQ(device_.baud(), 1'000'000);
  EXPECT_EQ(error_of(4, 0x06, {0x01}), 0);
  run(500 * kMs);
  EXPECT_EQ(device_.baud(), 57'600);
  EXPECT_EQ(error_of(4, 0x06, {0xFF}), 0);
  run(500 * kMs);
  EXPECT_EQ(error_of(1, 0x01, {}), 0);
  EXPECT_EQ(error_of(1, 0x06, {0x55}), 4);
}

TEST_F(EmulatedDynamixel, TurnsAtASpeed) {
  ASSERT_EQ(write(11, {1}), 0);
  ASSERT_EQ(write(64, {1}), 0);
  ASSERT_EQ(write(104, number(-100)), 0);
  run(500 * kMs);
  EXPECT_NEAR(static_cast<std::int32_t>(read(128, 4)), -100, 1);
  EXPECT_EQ(read(122, 1), 1U) << "moving";
  ASSERT_EQ(write(104, number(0)), 0);
  run(500 * kMs);
  EXPECT_EQ(read(128, 4), 0U);
}

TEST_F(EmulatedDynamixel, LeadsIndirectAddressesToWhatTheyMean) {
  ASSERT_EQ(write(168, {132, 0, 133, 0, 65, 0}), 0);
  EXPECT_EQ(read(224, 2), 2048U);
  EXPECT_EQ(write(226, {1}), 0);
  EXPECT_EQ(read(65, 1), 1U);
  EXPECT_EQ(write(224, {1}), 7) << "read only as what it means";
}

}  // namespace
}  // namespace odoless
