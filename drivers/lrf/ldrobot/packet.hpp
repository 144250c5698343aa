#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

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

/// Finds packets in a stream of bytes. After damage it looks for the next start within what it has kept, so that no
/// other packet is lost.
///
/// Thread: one thread. Real time: no allocation; time linear in the bytes, times kPacketBytes where all are garbage.
class PacketReader {
 public:
  enum class Outcome : std::uint8_t {
    kMore,      ///< all bytes are used, and no packet is complete
    kPacket,    ///< `packet` holds one
    kSkipped,   ///< bytes are thrown away up to what looks like a start
    kWrongSum,  ///< what looked like a packet has the wrong sum, or angles that cannot be
  };

  /// Takes bytes off the front of `bytes` until something is found. Call until it says kMore.
  [[nodiscard]] Outcome take(std::span<const std::byte>& bytes);
  [[nodiscard]] const Packet& packet() const { return packet_; }
  void clear() { size_ = 0; }

 private:
  [[nodiscard]] bool can_start() const;
  [[nodiscard]] bool decode();
  void drop_to_next_start();

  std::array<std::byte, kPacketBytes> buffer_{};
  std::size_t size_ = 0;
  bool told_ = false;  ///< that bytes are skipped, since the last packet
  Packet packet_;
};

}  // namespace odoless::ldrobot
