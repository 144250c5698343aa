#include "drivers/lrf/sick/telegram.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <initializer_list>
#include <vector>

namespace odoless::sick {
namespace {

using Outcome = TelegramReader::Outcome;

std::vector<std::byte> bytes_of(std::initializer_list<int> values) {
  std::vector<std::byte> bytes;
  for (const int value : values) {
    bytes.push_back(static_cast<std::byte>(value));
  }
  return bytes;
}

std::vector<std::byte> request(std::initializer_list<int> payload) {
  const std::vector<std::byte> bytes = bytes_of(payload);
  const Request made(bytes);
  return {made.bytes().begin(), made.bytes().end()};
}

/// A whole telegram from the device.
std::vector<std::byte> telegram(std::initializer_list<int> payload) {
  std::vector<std::byte> bytes = bytes_of({0x02, 0x80, static_cast<int>(payload.size()), 0});
  for (const int value : payload) {
    bytes.push_back(static_cast<std::byte>(value));
  }
  const std::uint16_t sum = checksum(bytes);
  bytes.push_back(static_cast<std::byte>(sum & 0xFFU));
  bytes.push_back(static_cast<std::byte>(sum >> 8U));
  return bytes;
}

std::vector<Outcome> outcomes(TelegramReader& reader, const std::vector<std::byte>& bytes) {
  std::vector<Outcome> found;
  std::span<const std::byte> rest(bytes);
  for (Outcome outcome = reader.take(rest); outcome != Outcome::kMore; outcome = reader.take(rest)) {
    found.push_back(outcome);
  }
  return found;
}

// As published in the vendor's description and seen on the wire.
TEST(SickTelegram, RequestsHaveThePublishedBytes) {
  EXPECT_EQ(request({0x20, 0x24}), bytes_of({2, 0, 2, 0, 0x20, 0x24, 0x34, 0x08}));
  EXPECT_EQ(request({0x20, 0x25}), bytes_of({2, 0, 2, 0, 0x20, 0x25, 0x35, 0x08}));
  EXPECT_EQ(request({0x20, 0x42}), bytes_of({2, 0, 2, 0, 0x20, 0x42, 0x52, 0x08}));
  EXPECT_EQ(request({0x20, 0x48}), bytes_of({2, 0, 2, 0, 0x20, 0x48, 0x58, 0x08}));
  EXPECT_EQ(request({0x31}), bytes_of({2, 0, 1, 0, 0x31, 0x15, 0x12}));
  EXPECT_EQ(request({0x74}), bytes_of({2, 0, 1, 0, 0x74, 0x50, 0x12}));
  EXPECT_EQ(request({0x3B, 0xB4, 0, 0x32, 0}), bytes_of({2, 0, 5, 0, 0x3B, 0xB4, 0, 0x32, 0, 0x3B, 0x1F}));
  EXPECT_EQ(request({0x3B, 0xB4, 0, 0x64, 0}), bytes_of({2, 0, 5, 0, 0x3B, 0xB4, 0, 0x64, 0, 0x97, 0x49}));
  EXPECT_EQ(request({0x3B, 0x64, 0, 0x19, 0}), bytes_of({2, 0, 5, 0, 0x3B, 0x64, 0, 0x19, 0, 0xE7, 0x72}));
  EXPECT_EQ(request({0x20, 0, 'S', 'I', 'C', 'K', '_', 'L', 'M', 'S'}),
            bytes_of({2, 0, 10, 0, 0x20, 0, 'S', 'I', 'C', 'K', '_', 'L', 'M', 'S', 0xBE, 0xC5}));
}

TEST(SickTelegram, TheSumSeesEveryChangeOfOneByte) {
  const std::vector<std::byte> bytes = telegram({0xB0, 0x01, 0x40, 0x10, 0x27, 0x00});
  const std::uint16_t sum = checksum(bytes);
  for (std::size_t at = 0; at < bytes.size(); ++at) {
    for (int change = 1; change < 256; ++change) {
      std::vector<std::byte> other = bytes;
      other[at] ^= static_cast<std::byte>(change);
      ASSERT_NE(checksum(other), sum) << "byte " << at << " changed by " << change;
    }
  }
}

TEST(SickTelegramReader, ReadsAnAnswer) {
  TelegramReader reader(100);
  std::vector<std::byte> bytes = telegram({0xA0, 0x00, 0x10});
  bytes.insert(bytes.begin(), kAck);
  EXPECT_THAT(outcomes(reader, bytes), ::testing::ElementsAre(Outcome::kUnderstood, Outcome::kTelegram));
  EXPECT_EQ(reader.telegram().command(), 0xA0);
  EXPECT_EQ(reader.telegram().data().size(), 1U);
  EXPECT_EQ(reader.telegram().status(), 0x10);
  EXPECT_THAT(outcomes(reader, {kNak}), ::testing::ElementsAre(Outcome::kNotUnderstood));
}

TEST(SickTelegramReader, AWrongLengthCostsNoOtherTelegram) {
  TelegramReader reader(100);
  std::vector<std::byte> bytes = telegram({0xA0, 0x00, 0x10});
  bytes[2] = std::byte{9};  // swallows the start of the next one
  const std::vector<std::byte> good = telegram({0xB1, 0x07, 0x00});
  bytes.insert(bytes.end(), good.begin(), good.end());
  EXPECT_THAT(outcomes(reader, bytes), ::testing::ElementsAre(Outcome::kWrongSum, Outcome::kTelegram));
  EXPECT_EQ(reader.telegram().command(), 0xB1);
}

TEST(SickTelegramReader, ALengthThatNoScanHasIsNotWaitedFor) {
  TelegramReader reader(400);
  reader.expect_stream(200);
  std::vector<std::byte> bytes = bytes_of({0x02, 0x80, 150, 0});
  const std::vector<std::byte> good = telegram({0x90, 'L', 'M', 'S', 0x00});
  bytes.insert(bytes.end(), good.begin(), good.end());
  EXPECT_THAT(outcomes(reader, bytes), ::testing::ElementsAre(Outcome::kSkipped, Outcome::kTelegram));
}

TEST(SickTelegramReader, NoiseIsToldOfOnceEachTime) {
  TelegramReader reader(400);
  reader.expect_stream(200);
  const std::vector<std::byte> noise(5000, std::byte{0x55});
  for (int i = 0; i < 2; ++i) {
    EXPECT_THAT(outcomes(reader, noise), ::testing::ElementsAre(Outcome::kSkipped));
    EXPECT_THAT(outcomes(reader, noise), ::testing::IsEmpty());
    EXPECT_THAT(outcomes(reader, telegram({0xA0, 0, 0})), ::testing::ElementsAre(Outcome::kTelegram));
  }
}

}  // namespace
}  // namespace odoless::sick
