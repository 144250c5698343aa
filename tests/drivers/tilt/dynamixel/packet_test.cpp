#include "drivers/tilt/dynamixel/packet.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

#include "core/base/rng.hpp"

namespace odoless::dynamixel {
namespace {

using Bytes = std::vector<std::uint8_t>;

Bytes encoded(int id, Instruction instruction, const Bytes& parameters) {
  const PacketBytes packet = encode(id, instruction, parameters);
  return {packet.span().begin(), packet.span().end()};
}

/// Every packet found in the bytes, given in pieces of at most `piece` bytes.
std::vector<Bytes> found_in(const Bytes& bytes, std::size_t piece = 1000) {
  PacketReader reader;
  std::vector<Bytes> found;
  for (std::size_t at = 0; at < bytes.size(); at += piece) {
    const std::size_t count = std::min(piece, bytes.size() - at);
    auto rest = std::as_bytes(std::span(bytes).subspan(at, count));
    for (auto outcome = reader.take(rest); outcome != PacketReader::Outcome::kMore; outcome = reader.take(rest)) {
      if (outcome == PacketReader::Outcome::kPacket) {
        const Packet& packet = reader.packet();
        Bytes content{packet.id, packet.instruction};
        content.insert(content.end(), packet.parameters.begin(),
                       packet.parameters.begin() + static_cast<std::ptrdiff_t>(packet.size));
        found.push_back(content);
      }
    }
  }
  return found;
}

// Robotis' e-Manual, examples of the protocol.
TEST(DynamixelPacket, IsAsInTheManual) {
  EXPECT_EQ(encoded(1, Instruction::kPing, {}), (Bytes{0xFF, 0xFF, 0xFD, 0, 1, 3, 0, 1, 0x19, 0x4E}));
  EXPECT_EQ(encoded(1, Instruction::kRead, {0x84, 0, 4, 0}),
            (Bytes{0xFF, 0xFF, 0xFD, 0, 1, 7, 0, 2, 0x84, 0, 4, 0, 0x1D, 0x15}));
  EXPECT_EQ(encoded(1, Instruction::kWrite, {0x74, 0, 0, 2, 0, 0}),
            (Bytes{0xFF, 0xFF, 0xFD, 0, 1, 9, 0, 3, 0x74, 0, 0, 2, 0, 0, 0xCA, 0x89}));
}

TEST(DynamixelPacket, CrcIsThatOfTheMethod) {
  const Bytes digits{'1', '2', '3', '4', '5', '6', '7', '8', '9'};
  EXPECT_EQ(crc16(digits), 0xFEE8) << "check value of CRC-16/UMTS";
  Rng rng(1);
  for (int i = 0; i < 200; ++i) {  // oracle: bit by bit
    Bytes bytes(rng.below(60));
    std::generate(bytes.begin(), bytes.end(), [&] { return static_cast<std::uint8_t>(rng.below(256)); });
    unsigned crc = 0;
    for (const unsigned byte : bytes) {
      for (int bit = 7; bit >= 0; --bit) {
        const bool top = ((crc >> 15U) & 1U) != ((byte >> static_cast<unsigned>(bit)) & 1U);
        crc = (crc << 1U & 0xFFFFU) ^ (top ? 0x8005U : 0U);
      }
    }
    ASSERT_EQ(crc16(bytes), crc);
  }
}

TEST(DynamixelPacket, AHeaderIsNowhereButInFront) {
  const Bytes parameters{0xFF, 0xFF, 0xFD, 0x00, 0xFF, 0xFF, 0xFD, 0xFF, 0xFF, 0xFD, 0xFD};
  const Bytes bytes = encoded(1, Instruction::kWrite, parameters);
  EXPECT_EQ(bytes[5], 3 + parameters.size() + 3);
  const Bytes header{0xFF, 0xFF, 0xFD, 0x00};
  EXPECT_EQ(std::search(bytes.begin() + 1, bytes.end(), header.begin(), header.end()), bytes.end());
  Bytes content{1, 3};
  content.insert(content.end(), parameters.begin(), parameters.end());
  EXPECT_THAT(found_in(bytes), ::testing::ElementsAre(content));
}

TEST(DynamixelPacket, GoesThereAndBackWhateverItHolds) {
  Rng rng(2);
  for (int i = 0; i < 5000; ++i) {
    Bytes content{static_cast<std::uint8_t>(rng.below(253)), static_cast<std::uint8_t>(Instruction::kWrite)};
    const std::uint32_t count = rng.below(60);
    for (std::uint32_t k = 0; k < count; ++k) {
      constexpr std::uint8_t kNasty[] = {0xFF, 0xFF, 0xFD, 0x00, 0x55};
      content.push_back(rng.below(4) == 0 ? static_cast<std::uint8_t>(rng.below(256)) : kNasty[rng.below(5)]);
    }
    const Bytes bytes = encoded(content[0], Instruction::kWrite, {content.begin() + 2, content.end()});
    ASSERT_THAT(found_in(bytes, 1 + rng.below(9)), ::testing::ElementsAre(content));
  }
}

/// A stream of status packets as a servo sends them, and where each begins.
struct Stream {
  Bytes bytes;
  std::vector<Bytes> packets;
};

Stream status_stream(int packets) {
  Stream stream;
  Rng rng(4);
  for (int i = 0; i < packets; ++i) {
    Bytes content{1, 0x55, 0};
    for (int k = 0; k < 16; ++k) {
      content.push_back(rng.below(3) == 0   ? 0xFF
                        : rng.below(3) == 0 ? 0xFD
                                            : static_cast<std::uint8_t>(rng.below(256)));
    }
    const Bytes one = encoded(1, Instruction::kStatus, {content.begin() + 2, content.end()});
    stream.bytes.insert(stream.bytes.end(), one.begin(), one.end());
    stream.packets.push_back(content);
  }
  return stream;
}

/// How many of `sent` are missing in `found`; -1 where something was found that was never sent, or out of order.
int lost(const std::vector<Bytes>& sent, const std::vector<Bytes>& found) {
  std::size_t next = 0;
  for (const Bytes& packet : found) {
    while (next < sent.size() && sent[next] != packet) {
      ++next;
    }
    if (next++ == sent.size()) {
      return -1;
    }
  }
  return static_cast<int>(sent.size() - found.size());
}

TEST(DynamixelPacket, OneDamagedByteCostsAtMostOnePacket) {
  const Stream stream = status_stream(6);
  const auto expect_one_lost = [&](Bytes bytes, std::size_t at, const char* how) {
    bytes.insert(bytes.end(), 200, 0x11);  // so that a packet that waits for more is given up
    const int gone = lost(stream.packets, found_in(bytes));
    ASSERT_TRUE(gone == 0 || gone == 1) << how << " at " << at << ": " << gone;
  };
  for (std::size_t at = 0; at < stream.bytes.size(); ++at) {
    for (unsigned change = 1; change < 256; ++change) {
      Bytes flipped = stream.bytes;
      flipped[at] = static_cast<std::uint8_t>(flipped[at] ^ change);
      expect_one_lost(flipped, at, "flipped");
    }
    // Not all values: 16 bits of check sum let one of 65536 through that shift the rest.
    for (const std::uint8_t value : Bytes{0x00, 0x01, 0x55, 0xFD, 0xFF}) {
      Bytes inserted = stream.bytes;
      inserted.insert(inserted.begin() + static_cast<std::ptrdiff_t>(at), value);
      expect_one_lost(inserted, at, "inserted");
    }
    Bytes dropped = stream.bytes;
    dropped.erase(dropped.begin() + static_cast<std::ptrdiff_t>(at));
    expect_one_lost(dropped, at, "dropped");
    Bytes doubled = stream.bytes;
    doubled.insert(doubled.begin() + static_cast<std::ptrdiff_t>(at), doubled[at]);
    expect_one_lost(doubled, at, "doubled");
  }
}

TEST(DynamixelPacket, AnySplitGivesTheSame) {
  const Stream stream = status_stream(20);
  for (std::size_t piece = 1; piece < 60; ++piece) {
    ASSERT_EQ(found_in(stream.bytes, piece), stream.packets) << piece;
  }
}

TEST(DynamixelPacket, NoiseGivesNoPacketsAndEnds) {
  Rng rng(6);
  std::size_t found = 0;
  for (int i = 0; i < 300; ++i) {
    Bytes bytes(1000);
    constexpr std::uint8_t kNasty[] = {0xFF, 0xFF, 0xFD, 0x00, 0x01, 0x07, 0x00, 0x55};
    std::generate(bytes.begin(), bytes.end(),
                  [&] { return rng.below(5) == 0 ? static_cast<std::uint8_t>(rng.below(256)) : kNasty[rng.below(8)]; });
    found += found_in(bytes).size();
  }
  EXPECT_LE(found, 3U) << "16 bits of check sum let one of 65536 through";
}

}  // namespace
}  // namespace odoless::dynamixel
