#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

namespace odoless {

/// What is wired to a robot's GPIO lines: the first two tell the daemon something, the others are told.
enum class GpioPin : std::uint8_t { kStop, kSync, kPower, kLed };
inline constexpr std::array<const char*, 4> kGpioPinNames{"stop", "sync", "power", "led"};
inline constexpr std::size_t kGpioInputs = 2;

/// What is on a line; lost: it cannot be read any more.
enum class GpioLevel : std::uint8_t { kLow, kHigh, kLost };
inline constexpr std::array<const char*, 3> kGpioLevelNames{"low", "high", "lost"};

/// A line's new level, as the recorder keeps it: a word each and an end of line, "stop low\n".
struct GpioChange {
  GpioPin pin = GpioPin::kStop;
  GpioLevel level = GpioLevel::kLow;

  bool operator==(const GpioChange&) const = default;
};

/// Longest text of a change.
inline constexpr std::size_t kGpioTextMax = 16;

/// Real time: no allocation, no system call.
/// @return  The text, in `buffer`.
[[nodiscard]] std::string_view gpio_text(const GpioChange& change, std::span<char, kGpioTextMax> buffer);

/// Nothing where it is no such text.
[[nodiscard]] std::optional<GpioChange> parse_gpio_text(std::string_view text);

}  // namespace odoless
