#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "drivers/lrf/packet_finder.hpp"

namespace odoless::ldrobot {

inline constexpr std::size_t kPacketBytes = 47;
inline constexpr std::size_t kPacketPoints = 12;
inline constexpr std::int64_t kCounterWrapMs = 30'000;

/// CRC of a packet: 8 bits, polynomial 4Dh, started at 0, not reflected.
[[nodiscard]] std::uint8_t checksum(std::span<const std::byte> bytes);

/// One measurement.
struct Point {
  double range_m = 0.0;  ///< 0: nothing answered
  std::uint8_t strength = 0;
};

/// Twelve measurements and how the mirror turned meanwhile: 54h, 2Ch, speed, angle of the first point, the points
/// (range, strength), angle of the last point, counter, CRC; numbers of 2 bytes, the lower one first.
struct Packet {
  double speed_degps = 0.0;
  double first_deg = 0.0;  ///< clockwise from the front, 0 up to 360
  double sweep_deg = 0.0;  ///< from there to the last point
  int counter_ms = 0;      ///< back to 0 after kCounterWrapMs
  std::array<Point, kPacketPoints> points{};

  [[nodiscard]] double angle_deg(std::size_t point) const {
    const double angle_deg = first_deg + sweep_deg * static_cast<double>(point) / (kPacketPoints - 1);
    return angle_deg < 360.0 ? angle_deg : angle_deg - 360.0;
  }
};

/// See PacketFinder. Wrong are also angles, a speed and a counter that cannot be.
class PacketFormat {
 public:
  static constexpr std::byte kStart{0x54};

  [[nodiscard]] static bool can_start(std::span<const std::byte> bytes);
  [[nodiscard]] static std::size_t size_bytes(std::span<const std::byte> /*bytes*/) { return kPacketBytes; }
  [[nodiscard]] bool decode(std::span<const std::byte> bytes);
  [[nodiscard]] const Packet& packet() const { return packet_; }

 private:
  Packet packet_;
};
using PacketReader = PacketFinder<PacketFormat, kPacketBytes>;

}  // namespace odoless::ldrobot
