#pragma once

#include <cstddef>
#include <span>

/// Numbers in RPLIDAR's packets: the lower byte first.
namespace odoless::rplidar {

[[nodiscard]] inline unsigned byte_at(std::span<const std::byte> bytes, std::size_t i) {
  return std::to_integer<unsigned>(bytes[i]);
}
[[nodiscard]] inline unsigned number_at(std::span<const std::byte> bytes, std::size_t i) {
  return byte_at(bytes, i) | (byte_at(bytes, i + 1) << 8U);
}
[[nodiscard]] inline unsigned long_at(std::span<const std::byte> bytes, std::size_t i) {
  return number_at(bytes, i) | (number_at(bytes, i + 2) << 16U);
}

[[nodiscard]] inline unsigned xor_of(std::span<const std::byte> bytes) {
  std::byte sum{0};
  for (const std::byte byte : bytes) {
    sum ^= byte;
  }
  return std::to_integer<unsigned>(sum);
}

/// Whether these may be the first bytes of a capsule.
[[nodiscard]] inline bool is_marked(std::span<const std::byte> bytes) {
  return (byte_at(bytes, 0) >> 4U) == 0xAU && (byte_at(bytes, 1) >> 4U) == 0x5U;
}

}  // namespace odoless::rplidar
