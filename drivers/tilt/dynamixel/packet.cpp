#include "drivers/tilt/dynamixel/packet.hpp"

#include <algorithm>

namespace odoless::dynamixel {
namespace {

constexpr std::array<std::uint8_t, 4> kHeader{0xFF, 0xFF, 0xFD, 0x00};
constexpr std::size_t kBeforeInstruction = 7;
constexpr std::size_t kCrcBytes = 2;
constexpr std::size_t kShortest = kBeforeInstruction + 1 + kCrcBytes;

constexpr std::array<std::uint16_t, 256> crc_table() {
  std::array<std::uint16_t, 256> table{};
  for (unsigned i = 0; i < table.size(); ++i) {
    unsigned rest = i << 8U;
    for (int bit = 0; bit < 8; ++bit) {
      rest = (rest & 0x8000U) != 0 ? (rest << 1U) ^ 0x8005U : rest << 1U;
    }
    table[i] = static_cast<std::uint16_t>(rest);
  }
  return table;
}

constexpr std::array<std::uint16_t, 256> kCrcTable = crc_table();

void append(PacketBytes& packet, std::uint8_t byte) {
  ODOLESS_CHECK(packet.size < packet.bytes.size());
  packet.bytes[packet.size++] = byte;
}

std::size_t number_of(std::uint8_t low, std::uint8_t high) { return std::size_t{high} << 8U | low; }

/// Whether the last three bytes are the header's first three.
bool ends_like_header(std::span<const std::uint8_t> bytes) {
  return bytes.size() >= 3 && std::equal(bytes.end() - 3, bytes.end(), kHeader.begin());
}

}  // namespace

std::uint16_t crc16(std::span<const std::uint8_t> bytes) {
  unsigned crc = 0;
  for (const std::uint8_t byte : bytes) {
    crc = (crc << 8U & 0xFFFFU) ^ kCrcTable[(crc >> 8U ^ byte) & 0xFFU];
  }
  return static_cast<std::uint16_t>(crc);
}

PacketBytes encode(int id, Instruction instruction, std::span<const std::uint8_t> parameters) {
  PacketBytes packet;
  std::copy(kHeader.begin(), kHeader.end(), packet.bytes.begin());
  packet.bytes[4] = static_cast<std::uint8_t>(id);
  packet.size = kBeforeInstruction;
  append(packet, static_cast<std::uint8_t>(instruction));
  for (const std::uint8_t byte : parameters) {
    append(packet, byte);
    if (ends_like_header(packet.span().subspan(kBeforeInstruction))) {
      append(packet, 0xFD);
    }
  }
  const std::size_t length = packet.size - kBeforeInstruction + kCrcBytes;
  packet.bytes[5] = static_cast<std::uint8_t>(length & 0xFFU);
  packet.bytes[6] = static_cast<std::uint8_t>(length >> 8U);
  const std::uint16_t crc = crc16(packet.span());
  append(packet, static_cast<std::uint8_t>(crc & 0xFFU));
  append(packet, static_cast<std::uint8_t>(crc >> 8U));
  return packet;
}

std::uint32_t Packet::get(std::size_t at, std::size_t size_bytes) const {
  std::uint32_t value = 0;
  for (std::size_t i = size_bytes; i-- > 0;) {
    value = value << 8U | parameters[1 + at + i];
  }
  return value;
}

void PacketReader::drop(std::size_t count) {
  std::copy(buffer_.begin() + static_cast<std::ptrdiff_t>(count), buffer_.begin() + static_cast<std::ptrdiff_t>(count_),
            buffer_.begin());
  count_ -= count;
}

PacketReader::Outcome PacketReader::take(std::span<const std::byte>& bytes) {
  while (true) {
    const Outcome outcome = look();
    if (outcome != Outcome::kMore || bytes.empty()) {
      return outcome;
    }
    buffer_[count_++] = static_cast<std::uint8_t>(bytes.front());
    bytes = bytes.subspan(1);
  }
}

// One reason per damaged stretch is enough.
PacketReader::Outcome PacketReader::look() {
  while (true) {
    const Damage damage = damage_at_front();
    if (damage.reason == Errc::kOk) {
      return damage.bytes == 0 ? Outcome::kMore : Outcome::kPacket;
    }
    drop(damage.bytes);
    if (!told_) {
      told_ = true;
      error_ = damage.reason;
      return Outcome::kBad;
    }
  }
}

PacketReader::Damage PacketReader::damage_at_front() {
  const auto begin = buffer_.begin();
  const auto end = begin + static_cast<std::ptrdiff_t>(count_);
  const auto compared = static_cast<std::ptrdiff_t>(std::min(count_, kHeader.size()));
  if (!std::equal(begin, begin + compared, kHeader.begin())) {
    return {1, Errc::kFrameMalformed};
  }
  if (count_ < kBeforeInstruction) {
    return {};
  }
  const std::size_t total = kBeforeInstruction + number_of(buffer_[5], buffer_[6]);
  if (total < kShortest || total > kPacketMaxBytes) {
    return {1, Errc::kFrameMalformed};
  }
  if (count_ >= total) {
    return decode() ? Damage{total, Errc::kOk} : Damage{1, Errc::kWrongSum};
  }
  // A header within: the rest of this packet never came.
  const auto next = std::search(begin + 1, end, kHeader.begin(), kHeader.end());
  return next == end ? Damage{} : Damage{static_cast<std::size_t>(next - begin), Errc::kFrameTruncated};
}

bool PacketReader::decode() {
  const std::size_t total = kBeforeInstruction + number_of(buffer_[5], buffer_[6]);
  const std::span<const std::uint8_t> all = std::span(buffer_).first(total);
  if (crc16(all.first(total - kCrcBytes)) != number_of(all[total - 2], all[total - 1])) {
    return false;
  }
  std::copy(all.begin(), all.end(), raw_.bytes.begin());
  raw_.size = total;
  packet_.id = all[4];
  packet_.instruction = all[kBeforeInstruction];
  packet_.size = 0;
  const std::span<const std::uint8_t> stuffed = all.subspan(kBeforeInstruction, total - kBeforeInstruction - kCrcBytes);
  for (std::size_t i = 1; i < stuffed.size(); ++i) {
    packet_.parameters[packet_.size++] = stuffed[i];
    const bool is_stuffed = i + 1 < stuffed.size() && ends_like_header(stuffed.first(i + 1)) && stuffed[i + 1] == 0xFD;
    i += is_stuffed ? 1 : 0;
  }
  drop(total);
  told_ = false;
  return true;
}

}  // namespace odoless::dynamixel
