#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "drivers/io/can_frame.hpp"

namespace odoless {

/// Longest line that `candump_text` writes: an interface's name has 15 characters at most.
inline constexpr std::size_t kCandumpTextMax = 80;

/// Writes a frame as can-utils' candump -L does, without an end of line: (1700000000.123456) can0 181#3706000000000001
///
/// Real time: no allocation, no system call.
/// @param stamp_us   At least 0.
/// @param interface  What is beyond 15 characters of it is left out.
/// @return  The line, in `buffer`.
[[nodiscard]] std::string_view candump_text(std::int64_t stamp_us, std::string_view interface, const CanFrame& frame,
                                            std::span<char, kCandumpTextMax> buffer);

}  // namespace odoless
