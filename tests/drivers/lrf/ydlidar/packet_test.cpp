#include "drivers/lrf/ydlidar/packet.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <initializer_list>
#include <vector>

#include "core/base/rng.hpp"

namespace odoless::ydlidar {
namespace {

using Bytes = std::vector<std::byte>;
using Outcome = PacketReader::Outcome;

Bytes bytes_of(std::initializer_list<int> values) {
  Bytes bytes;
  for (const int value : values) {
    bytes.push_back(static_cast<std::byte>(value));
  }
  return bytes;
}

/// The example of YDLIDAR's description of the protocol: a turn begins.
const Bytes kExample = bytes_of({0xAA, 0x55, 0x01, 0x01, 0x53, 0xAE, 0x53, 0xAE, 0xAB, 0x54, 0x00, 0x00});

/// With the angles of the manuals' example, FSA = 6FE5h and LSA = 79BDh, and forty samples.
Bytes packet_of(const std::vector<int>& samples, int first_angle = 0x6FE5, int last_angle = 0x79BD) {
  Bytes bytes = bytes_of({0xAA, 0x55, 0, static_cast<int>(samples.size()), first_angle & 0xFF, first_angle >> 8,
                          last_angle & 0xFF, last_angle >> 8, 0, 0});
  for (const int sample : samples) {
    bytes.push_back(static_cast<std::byte>(sample & 0xFF));
    bytes.push_back(static_cast<std::byte>(sample >> 8));
  }
  const std::uint16_t sum = check_word(bytes);
  bytes[8] = static_cast<std::byte>(sum & 0xFFU);
  bytes[9] = static_cast<std::byte>(sum >> 8U);
  return bytes;
}

/// Every outcome but kMore, in order, where the bytes come in pieces of that size; and how many samples there were.
struct Found {
  std::vector<Outcome> outcomes;
  std::vector<std::size_t> counts;

  [[nodiscard]] auto times(Outcome outcome) const { return std::ranges::count(outcomes, outcome); }
};

Found read(const Bytes& bytes, std::size_t step) {
  PacketReader reader;
  Found found;
  for (std::size_t at = 0; at < bytes.size(); at += step) {
    auto piece = std::span(bytes).subspan(at, std::min(step, bytes.size() - at));
    for (Outcome outcome = reader.take(piece); outcome != Outcome::kMore; outcome = reader.take(piece)) {
      found.outcomes.push_back(outcome);
      if (outcome == Outcome::kPacket) {
        found.counts.push_back(reader.packet().count);
      }
    }
  }
  return found;
}

Bytes together(const std::vector<Bytes>& parts) {
  Bytes all;
  for (const Bytes& part : parts) {
    all.insert(all.end(), part.begin(), part.end());
  }
  return all;
}

TEST(YdlidarPacket, TheDescriptionsExampleIsUnderstood) {
  PacketReader reader;
  std::span<const std::byte> bytes = kExample;
  ASSERT_EQ(reader.take(bytes), Outcome::kPacket);
  EXPECT_EQ(reader.packet().count, 1U);
  EXPECT_EQ(reader.packet().samples[0], 0);
  EXPECT_DOUBLE_EQ(reader.packet().first_deg, (0xAE53 >> 1) / 64.0);
  EXPECT_DOUBLE_EQ(reader.packet().angle_deg(0), (0xAE53 >> 1) / 64.0);
}

TEST(YdlidarPacket, AnglesLieEvenlyBetweenTheFirstAndTheLast) {
  const Bytes packet = packet_of(std::vector<int>(40, 0x6FE5));
  PacketReader reader;
  std::span<const std::byte> bytes = packet;
  ASSERT_EQ(reader.take(bytes), Outcome::kPacket);
  EXPECT_NEAR(reader.packet().angle_deg(0), 223.78, 0.006);
  EXPECT_NEAR(reader.packet().angle_deg(39), 243.47, 0.006);
  EXPECT_NEAR(reader.packet().angle_deg(1) - reader.packet().angle_deg(0), 19.69 / 39.0, 1e-3);
  EXPECT_EQ(reader.packet().samples[39], 0x6FE5) << "7161.25 mm by triangle";
}

TEST(YdlidarPacket, AnglesGoOnAcrossTheZero) {
  const Bytes packet = packet_of(std::vector<int>(11, 4000), 358 * 128 + 1, 8 * 128 + 1);
  PacketReader reader;
  std::span<const std::byte> bytes = packet;
  ASSERT_EQ(reader.take(bytes), Outcome::kPacket);
  EXPECT_DOUBLE_EQ(reader.packet().sweep_deg, 10.0);
  EXPECT_DOUBLE_EQ(reader.packet().angle_deg(1), 359.0);
  EXPECT_DOUBLE_EQ(reader.packet().angle_deg(3), 1.0);
}

TEST(YdlidarPacket, TheMirrorIsAheadOfWhatIsSeenAsTheDescriptionSays) {
  EXPECT_NEAR(parallax_deg(1.0), -6.7622, 1e-4);
  EXPECT_NEAR(parallax_deg(8.0), -7.8374, 1e-4);
  EXPECT_NEAR(parallax_deg(0.1553), 0.0, 1e-9);
  EXPECT_GT(parallax_deg(1e9), -kParallaxMaxDeg);
}

TEST(YdlidarPacket, AnySplitGivesTheSame) {
  const Bytes all = together({bytes_of({1, 0xAA, 0xAA}), packet_of({1, 2, 3}, 129, 257), kExample,
                              bytes_of({0xA5, 0x5A, 0x05}), packet_of(std::vector<int>(255, 7), 1, 255 * 128 + 1)});
  const Found whole = read(all, all.size());
  EXPECT_EQ(whole.counts, (std::vector<std::size_t>{3, 1, 255}));
  for (std::size_t step = 1; step < 100; ++step) {
    const Found found = read(all, step);
    EXPECT_EQ(found.outcomes, whole.outcomes) << step;
    EXPECT_EQ(found.counts, whole.counts) << step;
  }
}

TEST(YdlidarPacket, WhatCannotBeIsRefused) {
  EXPECT_EQ(read(packet_of({1, 2, 3}, 128, 257), 99).times(Outcome::kPacket), 0) << "an angle without its check bit";
  EXPECT_EQ(read(packet_of({1, 2, 3}, 129, 361 * 128 + 1), 99).times(Outcome::kPacket), 0) << "361 degrees";
  EXPECT_EQ(read(packet_of(std::vector<int>(11, 4000), 355 * 128 + 1, 360 * 128 + 1), 99).times(Outcome::kPacket), 0)
      << "360 degrees, which are 0";
  EXPECT_EQ(read(packet_of({1, 2, 3}, 129, 40 * 128 + 1), 99).times(Outcome::kPacket), 0) << "20 degrees per sample";
  EXPECT_EQ(read(packet_of({1}, 129, 257), 99).times(Outcome::kPacket), 0) << "one sample in two directions";
  Bytes empty = packet_of({1});
  empty[3] = std::byte{0};
  EXPECT_EQ(read(empty, 99).times(Outcome::kPacket), 0);
}

// A wrong number of samples takes the bytes that follow for its own until the check sum tells; they are searched again.
TEST(YdlidarPacket, ADamagedByteCostsItsOwnPacketAlone) {
  const Bytes packet = packet_of({100, 200, 300, 400}, 129, 6 * 128 + 1);
  std::vector<Bytes> parts(40, packet);
  Rng rng(3);
  for (std::size_t at = 0; at < packet.size(); ++at) {
    for (int attempt = 0; attempt < 20; ++attempt) {
      std::vector<Bytes> damaged = parts;
      damaged[5][at] ^= static_cast<std::byte>(1 + rng.below(255));
      const Found found = read(together(damaged), 1000);
      EXPECT_GE(found.times(Outcome::kPacket), 39) << "byte " << at;
    }
  }
}

}  // namespace
}  // namespace odoless::ydlidar
