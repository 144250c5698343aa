#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

/// Pololu's compact protocol for the Maestro: a command byte with its highest bit set, then bytes without it; numbers
/// have 14 bits, the lower 7 first. Answers have two bytes, the lower one first, and nothing around them.
namespace odoless::maestro {

enum class Code : std::uint8_t {
  kSetTarget = 0x84,
  kSetSpeed = 0x87,
  kSetAcceleration = 0x89,
  kGetPosition = 0x90,
  kGetErrors = 0xA1,  ///< and forgets them
};

inline constexpr std::size_t kAnswerBytes = 2;
inline constexpr unsigned kNumberMax = 0x3FFF;
inline constexpr unsigned kAccelerationMax = 255;

inline constexpr double kCountsPerUs = 4.0;                     ///< of a target and a position
inline constexpr double kSpeedUnitCountsPerS = 100.0;           ///< a count per 10 ms
inline constexpr double kAccelerationUnitCountsPerS2 = 1250.0;  ///< a count per 10 ms and 80 ms
inline constexpr unsigned kNoPulse = 0;                         ///< target and position of a servo that is off

/// Some commands, one after the other, as they are sent at once.
class Commands {
 public:
  void clear() { size_ = 0; }
  /// Code::kGetErrors.
  Commands& add(Code code);
  /// Code::kGetPosition.
  Commands& add(Code code, int channel);
  /// The others; what is beyond kNumberMax is cut to it.
  Commands& add(Code code, int channel, unsigned number);
  [[nodiscard]] std::span<const std::byte> bytes() const { return std::span(bytes_).first(size_); }

 private:
  void put(unsigned byte);

  std::array<std::byte, 16> bytes_{};
  std::size_t size_ = 0;
};

}  // namespace odoless::maestro
