#pragma once

#include <string>
#include <string_view>
#include <variant>

namespace odoless {

/// Who knows this may command: a text of at least `kTokenMin_bytes` letters, digits and signs, without spaces.
struct WebToken {
  std::string text;  ///< empty: nobody may

  /// @param authorization  The header of that name, "Bearer TOKEN". How long this takes tells nothing of the token.
  [[nodiscard]] bool allows(std::string_view authorization) const;
};

inline constexpr std::size_t kTokenMin_bytes = 16;
inline constexpr std::size_t kTokenMax_bytes = 256;

/// The token that a file has as its only line, or what is wrong with it, for a person: a file that everybody may read
/// is refused, too.
[[nodiscard]] std::variant<WebToken, std::string> read_token(const std::string& path);

}  // namespace odoless
