#include "drivers/lrf/ydlidar/packet.hpp"

#include <numbers>

#include "core/math/elementary.hpp"

namespace odoless::ydlidar {
namespace {

constexpr std::byte kSecond{0x55};
constexpr std::size_t kCount = 3;
constexpr std::size_t kFirstAngle = 4;
constexpr std::size_t kLastAngle = 6;
constexpr std::size_t kCheckWord = 8;

constexpr unsigned kCheckBit = 1;  ///< of an angle, which is always set
constexpr double kPerDegree = 64.0;
constexpr double kTurnDeg = 360.0;
constexpr double kSweepMaxDeg = 4.0;  ///< from sample to sample: 3000 a second at 30 turns a second have 3.6

// Of the geometry of all these lasers: the distance of the receiver from the laser, and the range at which both look
// into the same direction.
constexpr double kBaselineMm = 21.8;
constexpr double kStraightMm = 155.3;

unsigned number_at(std::span<const std::byte> bytes, std::size_t at) {
  return std::to_integer<unsigned>(bytes[at]) | std::to_integer<unsigned>(bytes[at + 1]) << 8U;
}

}  // namespace

std::uint16_t check_word(std::span<const std::byte> packet) {
  unsigned sum = 0;
  for (std::size_t at = 0; at + 1 < packet.size(); at += 2) {
    sum ^= at == kCheckWord ? 0U : number_at(packet, at);
  }
  return static_cast<std::uint16_t>(sum);
}

double parallax_deg(double range_m) {
  const double range_mm = range_m * 1000.0;
  return math::atan(kBaselineMm * (kStraightMm - range_mm) / (kStraightMm * range_mm)) * 180.0 / std::numbers::pi;
}

bool PacketFormat::can_start(std::span<const std::byte> bytes) {
  return (bytes.empty() || bytes[0] == kStart) && (bytes.size() < 2 || bytes[1] == kSecond) &&
         (bytes.size() <= kCount || bytes[kCount] != std::byte{0});
}

std::size_t PacketFormat::size_bytes(std::span<const std::byte> bytes) {
  const std::size_t count = bytes.size() <= kCount ? 1 : std::to_integer<std::size_t>(bytes[kCount]);
  return kHeadBytes + kSampleBytes * count;
}

bool PacketFormat::decode(std::span<const std::byte> bytes) {
  const unsigned first = number_at(bytes, kFirstAngle);
  const unsigned last = number_at(bytes, kLastAngle);
  const double first_deg = (first >> 1U) / kPerDegree;
  const double last_deg = (last >> 1U) / kPerDegree;
  if (check_word(bytes) != number_at(bytes, kCheckWord) || (first & last & kCheckBit) == 0 || first_deg >= kTurnDeg ||
      last_deg >= kTurnDeg) {
    return false;
  }
  const std::size_t count = (bytes.size() - kHeadBytes) / kSampleBytes;
  const double sweep_deg = last_deg < first_deg ? last_deg + kTurnDeg - first_deg : last_deg - first_deg;
  if (sweep_deg > kSweepMaxDeg * static_cast<double>(count - 1)) {
    return false;
  }
  packet_.first_deg = first_deg;
  packet_.sweep_deg = sweep_deg;
  packet_.count = count;
  for (std::size_t i = 0; i < count; ++i) {
    packet_.samples[i] = static_cast<std::uint16_t>(number_at(bytes, kHeadBytes + kSampleBytes * i));
  }
  return true;
}

}  // namespace odoless::ydlidar
