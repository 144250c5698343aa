#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

namespace odoless {

/// Fewest letters to insert, remove or replace to make `to` of `from`; takes time as both are long.
[[nodiscard]] std::size_t edit_distance(std::string_view from, std::string_view to);

/// The name that somebody who wrote `word` most likely meant, or nothing if none is near.
[[nodiscard]] std::string nearest_name(std::string_view word, std::span<const std::string> names);

}  // namespace odoless
