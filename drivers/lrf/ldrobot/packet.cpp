#include "drivers/lrf/ldrobot/packet.hpp"

namespace odoless::ldrobot {
namespace {

constexpr std::byte kKind{0x2C};  ///< of points; the lower 5 bits are their number
constexpr std::size_t kSpeed = 2;
constexpr std::size_t kFirstAngle = 4;
constexpr std::size_t kPoints = 6;
constexpr std::size_t kPointBytes = 3;
constexpr std::size_t kLastAngle = kPoints + kPointBytes * kPacketPoints;
constexpr std::size_t kCounter = kLastAngle + 2;
constexpr std::size_t kSum = kCounter + 2;
static_assert(kSum + 1 == kPacketBytes);

constexpr unsigned kTurnCdeg = 36'000;
constexpr unsigned kSweepMaxCdeg = 9'000;   ///< of a packet
constexpr unsigned kSpeedMaxDegps = 7'200;  ///< 20 turns a second

constexpr std::size_t kSumStep = 8;  ///< bytes that go into the sum at once
using SumTables = std::array<std::array<std::uint8_t, 256>, kSumStep>;

/// Of how a byte changes the sum, with as many bytes behind it as the table has before it.
constexpr SumTables sum_tables() {
  SumTables tables{};
  for (unsigned i = 0; i < 256; ++i) {
    unsigned rest = i;
    for (auto& table : tables) {
      for (int bit = 0; bit < 8; ++bit) {
        rest = (rest & 0x80U) != 0 ? ((rest << 1U) ^ 0x4DU) & 0xFFU : rest << 1U;
      }
      table[i] = static_cast<std::uint8_t>(rest);
    }
  }
  return tables;
}

constexpr SumTables kSumTables = sum_tables();

unsigned number_at(std::span<const std::byte> bytes, std::size_t at) {
  return std::to_integer<unsigned>(bytes[at]) | std::to_integer<unsigned>(bytes[at + 1]) << 8U;
}

}  // namespace

std::uint8_t checksum(std::span<const std::byte> bytes) {
  const auto number = [](std::byte byte) { return std::to_integer<std::uint8_t>(byte); };
  std::uint8_t sum = 0;
  for (; bytes.size() >= kSumStep; bytes = bytes.subspan(kSumStep)) {
    unsigned next = kSumTables[kSumStep - 1][sum ^ number(bytes[0])];
    for (std::size_t i = 1; i < kSumStep; ++i) {
      next ^= kSumTables[kSumStep - 1 - i][number(bytes[i])];
    }
    sum = static_cast<std::uint8_t>(next);
  }
  for (const std::byte byte : bytes) {
    sum = kSumTables[0][sum ^ number(byte)];
  }
  return sum;
}

bool PacketFormat::can_start(std::span<const std::byte> bytes) {
  return (bytes.empty() || bytes[0] == kStart) && (bytes.size() < 2 || bytes[1] == kKind);
}

bool PacketFormat::decode(std::span<const std::byte> bytes) {
  const unsigned first_cdeg = number_at(bytes, kFirstAngle);
  const unsigned last_cdeg = number_at(bytes, kLastAngle);
  const unsigned speed_degps = number_at(bytes, kSpeed);
  const unsigned counter_ms = number_at(bytes, kCounter);
  if (checksum(bytes.first(kSum)) != std::to_integer<std::uint8_t>(bytes[kSum]) || first_cdeg >= kTurnCdeg ||
      last_cdeg >= kTurnCdeg || speed_degps > kSpeedMaxDegps || counter_ms > kCounterWrapMs) {
    return false;
  }
  const unsigned sweep_cdeg = (last_cdeg + kTurnCdeg - first_cdeg) % kTurnCdeg;
  if (sweep_cdeg > kSweepMaxCdeg) {
    return false;
  }
  packet_.speed_degps = speed_degps;
  packet_.first_deg = first_cdeg * 0.01;
  packet_.sweep_deg = sweep_cdeg * 0.01;
  packet_.counter_ms = static_cast<int>(counter_ms);
  for (std::size_t i = 0; i < kPacketPoints; ++i) {
    const std::size_t at = kPoints + kPointBytes * i;
    packet_.points[i] = {number_at(bytes, at) * 0.001, std::to_integer<std::uint8_t>(bytes[at + 2])};
  }
  return true;
}

}  // namespace odoless::ldrobot
