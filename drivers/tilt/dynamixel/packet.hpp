#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/result.hpp"

/// Dynamixel Protocol 2.0: FF FF FD 00, id, length (2 bytes), instruction, parameters, CRC (2 bytes). Within
/// instruction and parameters FF FF FD is followed by one more FD, so that a header can be nowhere else.
namespace odoless::dynamixel {

enum class Instruction : std::uint8_t {
  kPing = 0x01,
  kRead = 0x02,
  kWrite = 0x03,
  kReboot = 0x08,
  kStatus = 0x55,
};

/// Longest packet that is ever sent or expected, stuffing included.
inline constexpr std::size_t kPacketMaxBytes = 128;

/// CRC-16 with polynomial 8005h, started at 0, not reflected (CRC-16/UMTS).
[[nodiscard]] std::uint16_t crc16(std::span<const std::uint8_t> bytes);

/// A packet as it is on the line.
struct PacketBytes {
  std::array<std::uint8_t, kPacketMaxBytes> bytes{};
  std::size_t size = 0;

  [[nodiscard]] std::span<const std::uint8_t> span() const { return std::span(bytes).first(size); }
};

/// @param parameters  Few enough that the packet fits, even if all must be stuffed.
[[nodiscard]] PacketBytes encode(int id, Instruction instruction, std::span<const std::uint8_t> parameters);

/// A packet without header, stuffing and CRC.
struct Packet {
  std::uint8_t id = 0;
  std::uint8_t instruction = 0;  ///< of a status packet: kStatus, and its first parameter is the error
  std::array<std::uint8_t, kPacketMaxBytes> parameters{};
  std::size_t size = 0;  ///< of the parameters

  [[nodiscard]] bool is_status() const {
    return instruction == static_cast<std::uint8_t>(Instruction::kStatus) && size >= 1;
  }
  [[nodiscard]] std::uint8_t error() const { return parameters[0]; }
  /// `size_bytes` (1, 2 or 4) of a status packet's data from `at` on, little-endian.
  [[nodiscard]] std::uint32_t get(std::size_t at, std::size_t size_bytes) const;
};

/// Finds packets in a stream of bytes. A damaged one is skipped, and what follows is searched from within it, so that
/// none is lost but that one.
///
/// Thread: one thread. Real time: no allocation; time linear in the bytes, times kPacketMaxBytes where all are garbage.
class PacketReader {
 public:
  enum class Outcome : std::uint8_t {
    kMore,    ///< all bytes are taken, no packet is complete
    kPacket,  ///< `packet` holds one; call again
    kBad,     ///< something was skipped for `error`; call again
  };

  /// Takes bytes from the front of `bytes` until something is found. Call until it says kMore.
  [[nodiscard]] Outcome take(std::span<const std::byte>& bytes);
  void clear() { count_ = 0; }

  [[nodiscard]] const Packet& packet() const { return packet_; }
  [[nodiscard]] Errc error() const { return error_; }
  /// The packet as it was on the line.
  [[nodiscard]] std::span<const std::uint8_t> raw() const { return std::span(raw_.bytes).first(raw_.size); }

 private:
  /// What is wrong with the first bytes of the buffer. kOk: nothing; then `bytes` is 0 or those of a packet.
  struct Damage {
    std::size_t bytes = 0;
    Errc reason = Errc::kOk;
  };

  [[nodiscard]] Outcome look();
  [[nodiscard]] Damage damage_at_front();
  [[nodiscard]] bool decode();
  void drop(std::size_t count);

  std::array<std::uint8_t, kPacketMaxBytes> buffer_{};
  std::size_t count_ = 0;
  bool told_ = false;  ///< that something is wrong since the last packet
  Packet packet_;
  PacketBytes raw_;
  Errc error_ = Errc::kOk;
};

}  // namespace odoless::dynamixel
