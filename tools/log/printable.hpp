#pragma once

#include <algorithm>
#include <string>
#include <string_view>

namespace odoless {

/// The front of a text that anybody may have put into a file, as it can be shown on a terminal.
[[nodiscard]] inline std::string printable(std::string_view text) {
  constexpr std::size_t kLongest = 255;
  std::string shown(text.substr(0, kLongest));
  std::replace_if(
      shown.begin(), shown.end(), [](char letter) { return letter < ' ' || letter > '~'; }, '?');
  return shown;
}

}  // namespace odoless
