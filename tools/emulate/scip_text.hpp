#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace odoless::scip {

/// `line` with its check sum and its end.
[[nodiscard]] std::string summed(std::string_view line);

/// A whole reply without data.
[[nodiscard]] std::string answer(std::string_view echo, std::string_view status);

/// "KEY:value;", the check sum, which leaves the semicolon out, and the line's end.
[[nodiscard]] std::string key_line(std::string_view key, std::string_view value);

/// The number in as many characters of 6 bits, the highest bits first; what is too large becomes the largest.
[[nodiscard]] std::string encoded(std::uint32_t value, int characters);

/// The text in lines of 64 characters with their sums and ends.
[[nodiscard]] std::string data_lines(std::string_view data);

/// The number in `digits` decimal digits of `text` from `start`; nothing where there is another character.
[[nodiscard]] std::optional<int> decimal(std::string_view text, std::size_t start, std::size_t digits);

}  // namespace odoless::scip
