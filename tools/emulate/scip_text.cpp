#include "tools/emulate/scip_text.hpp"

#include <algorithm>

#include "drivers/lrf/scip/number.hpp"

namespace odoless::scip {

std::string summed(std::string_view line) { return std::string(line) + checksum(line) + '\n'; }

std::string answer(std::string_view echo, std::string_view status) {
  return std::string(echo) + '\n' + summed(status) + '\n';
}

std::string key_line(std::string_view key, std::string_view value) {
  const std::string line = std::string(key) + ':' + std::string(value);
  return line + ';' + checksum(line) + '\n';
}

std::string encoded(std::uint32_t value, int characters) {
  const auto bits = static_cast<std::uint32_t>(6 * characters);
  const std::uint32_t fitting = std::min(value, (1U << bits) - 1U);
  std::string text;
  for (std::uint32_t shift = bits; shift > 0; shift -= 6) {
    text += encode(fitting >> (shift - 6));
  }
  return text;
}

std::string data_lines(std::string_view data) {
  constexpr std::size_t kCharacters = 64;
  std::string lines;
  for (std::size_t i = 0; i < data.size(); i += kCharacters) {
    lines += summed(data.substr(i, kCharacters));
  }
  return lines;
}

std::optional<int> decimal(std::string_view text, std::size_t start, std::size_t digits) {
  int value = 0;
  for (std::size_t i = start; i < start + digits; ++i) {
    if (i >= text.size() || text[i] < '0' || text[i] > '9') {
      return {};
    }
    value = value * 10 + (text[i] - '0');
  }
  return value;
}

}  // namespace odoless::scip
