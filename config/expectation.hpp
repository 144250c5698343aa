#pragma once

#include <span>
#include <string>
#include <string_view>

#include "config/entry.hpp"

namespace odoless {

/// A value as TOML writes it; a real number always as one.
[[nodiscard]] std::string value_text(const Entry::Value& value);

/// The same to be read and not to be kept: a number of many digits, as an angle's that is round in radians, has four.
[[nodiscard]] std::string short_text(const Entry::Value& value);

/// The range of an entry or its choices, for people: "0.1 to 20", or "rand1" or "best1"; empty for a flag and a text.
/// An end of many digits has three, and lies within.
[[nodiscard]] std::string range_text(const Entry& entry);

/// What would be right, to stand behind "must be".
[[nodiscard]] std::string expectation(const Entry& entry);

/// The name of the entry's kind: number, integer, boolean, choice, text.
[[nodiscard]] std::string_view kind_name(const Entry& entry);

/// The known key that somebody who wrote `key` most likely meant, or nothing if none is near.
[[nodiscard]] std::string_view nearest_key(std::string_view key, std::span<const Entry> entries);

}  // namespace odoless
