#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "drivers/lrf/packet_finder.hpp"

namespace odoless::ydlidar {

inline constexpr std::size_t kHeadBytes = 10;
inline constexpr std::size_t kSampleBytes = 2;
inline constexpr std::size_t kSamplesMax = 255;
inline constexpr std::size_t kPacketBytesMax = kHeadBytes + kSampleBytes * kSamplesMax;

inline constexpr std::array kScanRequest{std::byte{0xA5}, std::byte{0x60}};
/// What a device answers to it before its first packet.
inline constexpr std::array kScanAnswer{std::byte{0xA5}, std::byte{0x5A}, std::byte{0x05}, std::byte{0x00},
                                        std::byte{0x00}, std::byte{0x40}, std::byte{0x81}};

/// All words of a packet but its check word, one XORed with the other. @param packet  From its start to its last
/// sample.
[[nodiscard]] std::uint16_t check_word(std::span<const std::byte> packet);

/// By how much the direction of a point is ahead of the mirror, clockwise: a laser that triangulates has its receiver
/// beside it. Between -8 deg, far away, and some degrees, very near.
[[nodiscard]] double parallax_deg(double range_m);
inline constexpr double kParallaxMaxDeg = 8.0;

/// Some samples one after the other, and how the mirror turned meanwhile: AAh, 55h, kind (1: a turn begins), number of
/// samples, angle of the first and of the last, check word, samples; numbers of 2 bytes, the lower one first.
struct Packet {
  double first_deg = 0.0;  ///< the mirror's, clockwise, 0 up to 360
  double sweep_deg = 0.0;  ///< from there to the last sample
  std::size_t count = 0;
  std::array<std::uint16_t, kSamplesMax> samples{};  ///< ranges in the device's unit; 0: nothing answered

  [[nodiscard]] std::size_t size_bytes() const { return kHeadBytes + kSampleBytes * count; }
  [[nodiscard]] double angle_deg(std::size_t sample) const {
    const double steps = count > 1 ? static_cast<double>(count - 1) : 1.0;
    const double angle_deg = first_deg + sweep_deg * static_cast<double>(sample) / steps;
    return angle_deg < 360.0 ? angle_deg : angle_deg - 360.0;
  }
};

/// See PacketFinder. Wrong is also an angle that cannot be.
class PacketFormat {
 public:
  static constexpr std::byte kStart{0xAA};

  [[nodiscard]] static bool can_start(std::span<const std::byte> bytes);
  [[nodiscard]] static std::size_t size_bytes(std::span<const std::byte> bytes);
  [[nodiscard]] bool decode(std::span<const std::byte> bytes);
  [[nodiscard]] const Packet& packet() const { return packet_; }

 private:
  Packet packet_;
};
using PacketReader = PacketFinder<PacketFormat, kPacketBytesMax>;

}  // namespace odoless::ydlidar
