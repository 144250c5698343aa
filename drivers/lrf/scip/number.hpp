#pragma once

#include <cstdint>
#include <string_view>

namespace odoless::scip {

/// Check sum of a line: the low 6 bits of the sum of its bytes, as a character.
[[nodiscard]] char checksum(std::string_view line);

/// Whether the last character of `line` is the check sum of what is before it.
[[nodiscard]] bool sum_matches(std::string_view line);

/// Whether every character can stand in an encoded number: 0x30 to 0x6F.
[[nodiscard]] bool is_encoded(std::string_view text);

/// The number in 1 to 4 encoded characters of 6 bits each, the highest bits first.
[[nodiscard]] inline std::uint32_t decode(std::string_view text) {
  std::uint32_t value = 0;
  for (const char c : text) {
    value = (value << 6U) | ((static_cast<std::uint32_t>(static_cast<unsigned char>(c)) - 0x30U) & 0x3FU);
  }
  return value;
}

/// The character of 6 bits.
[[nodiscard]] inline char encode(std::uint32_t six_bits) { return static_cast<char>((six_bits & 0x3FU) + 0x30U); }

}  // namespace odoless::scip
