#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>

namespace odoless {

/// A classic CAN frame, laid out as the kernel's `struct can_frame`, so that one read or write of a raw socket is one
/// of these.
struct CanFrame {
  static constexpr std::uint32_t kErrorFlag = 0x20000000U;
  static constexpr std::uint32_t kRemoteFlag = 0x40000000U;
  static constexpr std::uint32_t kExtendedFlag = 0x80000000U;
  static constexpr std::uint32_t kErrorMask = 0x1FFFFFFFU;

  // Classes of an error frame (linux/can/error.h), in its id.
  static constexpr std::uint32_t kErrorBusOff = 0x040U;
  static constexpr std::uint32_t kErrorRestarted = 0x100U;

  std::uint32_t id = 0;  ///< 11 or 29 bits, and the flags
  std::uint8_t size_bytes = 0;
  std::array<std::uint8_t, 3> reserved{};
  std::array<std::uint8_t, 8> data{};

  [[nodiscard]] bool is_error() const { return (id & kErrorFlag) != 0; }
  /// Whether it has data and an id of 11 bits.
  [[nodiscard]] bool is_standard_data() const { return (id & (kErrorFlag | kRemoteFlag | kExtendedFlag)) == 0; }

  bool operator==(const CanFrame&) const = default;
};
static_assert(sizeof(CanFrame) == 16);

[[nodiscard]] inline std::span<const std::byte> as_bytes(const CanFrame& frame) {
  return std::as_bytes(std::span(&frame, 1));
}

/// The frame of these bytes; nothing where they are not exactly one.
[[nodiscard]] inline std::optional<CanFrame> to_can_frame(std::span<const std::byte> bytes) {
  CanFrame frame;
  if (bytes.size() != sizeof(frame)) {
    return std::nullopt;
  }
  std::memcpy(&frame, bytes.data(), sizeof(frame));
  return frame.size_bytes <= frame.data.size() ? std::optional(frame) : std::nullopt;
}

}  // namespace odoless
