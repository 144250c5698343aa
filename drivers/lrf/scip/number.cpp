#include "drivers/lrf/scip/number.hpp"

#include <algorithm>

namespace odoless::scip {

char checksum(std::string_view line) {
  std::uint32_t sum = 0;
  for (const char c : line) {
    sum += static_cast<unsigned char>(c);
  }
  return encode(sum);
}

bool sum_matches(std::string_view line) {
  return line.size() >= 2 && checksum(line.substr(0, line.size() - 1)) == line.back();
}

bool is_encoded(std::string_view text) {
  return std::all_of(text.begin(), text.end(), [](char c) { return c >= 0x30 && c <= 0x6F; });
}

}  // namespace odoless::scip
