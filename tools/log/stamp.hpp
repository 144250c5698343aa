#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

namespace odoless {

/// A decimal time, with or without exponent, as nanoseconds: exact, and rounded half away from zero below 1 ns.
/// Nothing when the text is no finite decimal number or is beyond +-292 years.
/// @param digits  Of nanoseconds in the unit: 9 for seconds, 6 for milliseconds, 3 for microseconds, 0 for nanoseconds.
[[nodiscard]] std::optional<std::int64_t> parse_stamp_ns(std::string_view text, int digits = 9);

/// A planar_lidar_t's stamp is in microseconds; scans of logs are made so that they stay the very same over LCM.
[[nodiscard]] constexpr std::int64_t to_message_precision(std::int64_t stamp_ns) { return stamp_ns - stamp_ns % 1000; }

/// From beam to beam, of a log that says it in seconds; 0, unknown, where that is not between 0 and 1.
[[nodiscard]] std::int64_t to_beam_period_ns(double time_increment_s);

/// Whether these stamps tell scans apart: not all zero, and not all equal when there are several.
[[nodiscard]] bool stamps_are_usable(std::span<const std::int64_t> stamps_ns);

}  // namespace odoless
