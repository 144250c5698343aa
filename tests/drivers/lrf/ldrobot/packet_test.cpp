#include "drivers/lrf/ldrobot/packet.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "core/base/rng.hpp"

namespace odoless::ldrobot {
namespace {

using Bytes = std::vector<std::byte>;

Bytes bytes_of(std::initializer_list<int> values) {
  Bytes bytes;
  for (const int value : values) {
    bytes.push_back(static_cast<std::byte>(value));
  }
  return bytes;
}

/// The example of LDROBOT's manual of the LD06.
const Bytes kExample =
    bytes_of({0x54, 0x2C, 0x68, 0x08, 0xAB, 0x7E, 0xE0, 0x00, 0xE4, 0xDC, 0x00, 0xE2, 0xD9, 0x00, 0xE5, 0xD5,
              0x00, 0xE3, 0xD3, 0x00, 0xE4, 0xD0, 0x00, 0xE9, 0xCD, 0x00, 0xE4, 0xCA, 0x00, 0xE2, 0xC7, 0x00,
              0xE9, 0xC5, 0x00, 0xE5, 0xC2, 0x00, 0xE5, 0xC0, 0x00, 0xE5, 0xBE, 0x82, 0x3A, 0x1A, 0x50});

/// How often each outcome came, the last kMore not counted.
struct Found {
  int packets = 0;
  int skipped = 0;
  int wrong_sums = 0;
  std::vector<double> first_deg;
};

Found read(const Bytes& bytes, std::size_t step) {
  PacketReader reader;
  Found found;
  for (std::size_t at = 0; at < bytes.size(); at += step) {
    auto piece = std::span(bytes).subspan(at, std::min(step, bytes.size() - at));
    for (auto outcome = reader.take(piece); outcome != PacketReader::Outcome::kMore; outcome = reader.take(piece)) {
      found.packets += outcome == PacketReader::Outcome::kPacket ? 1 : 0;
      found.skipped += outcome == PacketReader::Outcome::kSkipped ? 1 : 0;
      found.wrong_sums += outcome == PacketReader::Outcome::kWrongSum ? 1 : 0;
      if (outcome == PacketReader::Outcome::kPacket) {
        found.first_deg.push_back(reader.packet().first_deg);
      }
    }
  }
  return found;
}

/// As the manual defines it, bit by bit.
std::uint8_t plain_checksum(std::span<const std::byte> bytes) {
  unsigned sum = 0;
  for (const std::byte byte : bytes) {
    sum ^= std::to_integer<unsigned>(byte);
    for (int bit = 0; bit < 8; ++bit) {
      sum = (sum & 0x80U) != 0 ? ((sum << 1U) ^ 0x4DU) & 0xFFU : sum << 1U;
    }
  }
  return static_cast<std::uint8_t>(sum);
}

TEST(LdrobotPacket, ItsSumIsTheManualsOfAnyBytes) {
  Rng rng(7);
  for (std::size_t size = 0; size < 100; ++size) {
    Bytes bytes(size);
    std::generate(bytes.begin(), bytes.end(), [&] { return static_cast<std::byte>(rng.below(256)); });
    EXPECT_EQ(checksum(bytes), plain_checksum(bytes)) << size;
  }
}

TEST(LdrobotPacket, TheManualsExampleIsUnderstood) {
  PacketReader reader;
  std::span<const std::byte> bytes = kExample;
  ASSERT_EQ(reader.take(bytes), PacketReader::Outcome::kPacket);
  const Packet& packet = reader.packet();
  EXPECT_DOUBLE_EQ(packet.speed_degps, 2152.0);
  EXPECT_DOUBLE_EQ(packet.first_deg, 324.27);
  EXPECT_NEAR(packet.angle_deg(11), 334.7, 1e-9);
  EXPECT_NEAR(packet.angle_deg(1) - packet.angle_deg(0), 10.43 / 11.0, 1e-9);
  EXPECT_DOUBLE_EQ(packet.points[0].range_m, 0.224);
  EXPECT_EQ(packet.points[0].strength, 0xE4);
  EXPECT_DOUBLE_EQ(packet.points[11].range_m, 0.192);
  EXPECT_EQ(packet.counter_ms, 0x1A3A);
}

TEST(LdrobotPacket, AnglesGoOnAcrossTheFront) {
  Bytes bytes = kExample;
  bytes[4] = std::byte{0x68};  // 359.12 deg
  bytes[5] = std::byte{0x8C};
  bytes[42] = std::byte{0x5D};  // 9.25 deg
  bytes[43] = std::byte{0x02};
  bytes[46] = static_cast<std::byte>(checksum(std::span(bytes).first(46)));
  const Found found = read(bytes, 100);
  ASSERT_EQ(found.packets, 1);
  PacketReader reader;
  std::span<const std::byte> rest = bytes;
  ASSERT_EQ(reader.take(rest), PacketReader::Outcome::kPacket);
  double last_deg = -1.0;
  int wraps = 0;
  for (std::size_t i = 0; i < kPacketPoints; ++i) {
    const double angle_deg = reader.packet().angle_deg(i);
    ASSERT_GE(angle_deg, 0.0);
    ASSERT_LT(angle_deg, 360.0);
    wraps += angle_deg < last_deg ? 1 : 0;
    last_deg = angle_deg;
  }
  EXPECT_EQ(wraps, 1);
}

Bytes three_packets() {
  Bytes three;
  for (int i = 0; i < 3; ++i) {
    Bytes one = kExample;
    one[4] = static_cast<std::byte>(10 * i);
    one[42] = static_cast<std::byte>(10 * i);
    one[46] = static_cast<std::byte>(checksum(std::span(one).first(46)));
    three.insert(three.end(), one.begin(), one.end());
  }
  return three;
}

TEST(LdrobotPacket, AnySplitGivesTheSame) {
  Bytes bytes = three_packets();
  bytes.insert(bytes.begin() + 47, std::byte{0x54});
  for (const std::size_t step : {1U, 2U, 3U, 46U, 47U, 48U, 200U}) {
    const Found found = read(bytes, step);
    EXPECT_EQ(found.packets, 3) << step;
    EXPECT_EQ(found.skipped, 1) << step;
    EXPECT_EQ(found.wrong_sums, 0) << step;
  }
}

TEST(LdrobotPacket, DamageCostsItsOwnPacketAndNoOther) {
  Rng rng(4);
  const Bytes whole = three_packets();
  const std::vector<double> sent_deg = read(whole, 200).first_deg;
  for (std::size_t at = 47; at < 94; ++at) {
    for (int kind = 0; kind < 4; ++kind) {
      Bytes bytes = whole;
      const auto byte = bytes.begin() + static_cast<std::ptrdiff_t>(at);
      if (kind == 0) {
        *byte ^= static_cast<std::byte>(1 + rng.below(255));
      } else if (kind == 1) {
        bytes.erase(byte);
      } else {
        bytes.insert(byte, kind == 2 ? std::byte{0x54} : *byte);
      }
      const std::vector<double> found_deg = read(bytes, 1 + rng.below(60)).first_deg;
      ASSERT_GE(found_deg.size(), 2U) << kind << " at " << at;
      ASSERT_EQ(found_deg.front(), sent_deg.front()) << kind << " at " << at;
      ASSERT_EQ(found_deg.back(), sent_deg.back()) << kind << " at " << at;
      ASSERT_LE(found_deg.size(), 3U);
    }
  }
}

TEST(LdrobotPacket, WhatCannotBeIsRefusedThoughItsSumIsRight) {
  const auto refused = [](std::size_t at, int low, int high) {
    Bytes bytes = kExample;
    bytes[at] = static_cast<std::byte>(low);
    bytes[at + 1] = static_cast<std::byte>(high);
    bytes[46] = static_cast<std::byte>(checksum(std::span(bytes).first(46)));
    return read(bytes, 100).packets == 0;
  };
  EXPECT_TRUE(refused(4, 0xA0, 0x8C)) << "360.00 deg";
  EXPECT_TRUE(refused(42, 0x00, 0x30)) << "158.61 deg in a packet";
  EXPECT_FALSE(refused(42, 0x00, 0x83));
  EXPECT_TRUE(refused(2, 0x21, 0x1C)) << "7201 deg/s";
  EXPECT_TRUE(refused(44, 0x31, 0x75)) << "30001 ms";
}

}  // namespace
}  // namespace odoless::ldrobot
