#include "config/expectation.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstddef>
#include <variant>
#include <vector>

#include "config/misspelling.hpp"

namespace odoless {
namespace {

std::string real_text(double value) {
  std::string text = fmt::format("{}", value);
  if (text.find_first_of(".en") == std::string::npos) {
    text += ".0";
  }
  return text;
}

/// What has more digits than somebody would write, with `digits`, which `round` (std::floor and the like) leaves.
double shortened(double value, int digits, double (*round)(double)) {
  constexpr std::size_t kLongest = 8;  // with sign and point
  if (fmt::format("{}", value).size() <= kLongest) {
    return value;
  }
  const int decimals = digits - 1 - static_cast<int>(std::floor(std::log10(std::abs(value))));
  const double unit = std::pow(10.0, std::abs(decimals));
  return decimals > 0 ? round(value * unit) / unit : round(value / unit) * unit;
}

// Ranges are read by people: 20, not 20.0.
std::string bound_text(const Entry::Value& bound, double (*inwards)(double)) {
  constexpr int kDigits = 3;
  const auto* const real = std::get_if<double>(&bound);
  return real != nullptr ? fmt::format("{}", shortened(*real, kDigits, inwards)) : value_text(bound);
}

// A right name in the wrong table is nearer than most misspellings.
std::size_t key_distance(std::string_view key, std::string_view known) {
  return std::min(edit_distance(key, known), edit_distance(name_of(key), name_of(known)) + 1);
}

/// A text between quotes, as a basic string of TOML.
std::string quoted(std::string_view text) {
  std::string out = "\"";
  for (const char c : text) {
    out += c == '"' || c == '\\' ? std::string{'\\', c} : std::string(1, c);
  }
  return out + '"';
}

bool is_text(const Entry& entry) { return entry.names.empty() && std::holds_alternative<std::string>(entry.get()); }

}  // namespace

std::string value_text(const Entry::Value& value) {
  if (const auto* const real = std::get_if<double>(&value)) {
    return real_text(*real);
  }
  if (const auto* const whole = std::get_if<std::int64_t>(&value)) {
    return fmt::format("{}", *whole);
  }
  if (const auto* const flag = std::get_if<bool>(&value)) {
    return *flag ? "true" : "false";
  }
  if (const auto* const sectors = std::get_if<Entry::Sectors>(&value)) {
    std::vector<std::string> pairs;
    for (const auto& [from_deg, to_deg] : *sectors) {
      pairs.push_back(fmt::format("[{}, {}]", real_text(from_deg), real_text(to_deg)));
    }
    return fmt::format("[{}]", fmt::join(pairs, ", "));
  }
  return quoted(std::get<std::string>(value));
}

std::string short_text(const Entry::Value& value) {
  constexpr int kDigits = 4;
  const auto* const real = std::get_if<double>(&value);
  return value_text(real != nullptr ? shortened(*real, kDigits, std::round) : value);
}

std::string range_text(const Entry& entry) {
  if (!entry.names.empty()) {
    return fmt::format("\"{}\"", fmt::join(entry.names, "\" or \""));
  }
  if (std::holds_alternative<bool>(entry.get()) || is_text(entry)) {
    return {};
  }
  if (std::holds_alternative<Entry::Sectors>(entry.get())) {
    return fmt::format("at most {} pairs of -360 to 360 deg", kSectorsMax);
  }
  return fmt::format("{} to {}", bound_text(entry.min, std::ceil), bound_text(entry.max, std::floor));
}

std::string expectation(const Entry& entry) {
  constexpr std::array<std::string_view, 5> kForms{"{}", "a whole number, {}", "true or false", "{}",
                                                   "a list of sectors [from, to], {}"};
  std::string meaning = entry.text;
  if (meaning.ends_with('.')) {
    meaning.pop_back();
  }
  // Small in the middle of a sentence, unless the word is an abbreviation.
  if (meaning.size() > 1 && std::islower(static_cast<unsigned char>(meaning[1])) != 0) {
    meaning[0] = static_cast<char>(std::tolower(static_cast<unsigned char>(meaning[0])));
  }
  const std::string form = is_text(entry) ? fmt::format("a text of one line, at most {} bytes", kTextMaxBytes)
                                          : fmt::format(fmt::runtime(kForms[entry.get().index()]), range_text(entry));
  return fmt::format("{} ({})", form, meaning);
}

std::string_view kind_name(const Entry& entry) {
  constexpr std::array<std::string_view, 5> kNames{"number", "integer", "boolean", "choice", "sectors"};
  return is_text(entry) ? "text" : kNames[entry.get().index()];
}

std::string_view nearest_key(std::string_view key, std::span<const Entry> entries) {
  constexpr std::size_t kLongestKey = 100;  // longer ones are no misspelling, and the distance takes time
  if (entries.empty() || key.size() > kLongestKey) {
    return {};
  }
  const auto nearest = std::min_element(entries.begin(), entries.end(), [&](const Entry& a, const Entry& b) {
    return key_distance(key, a.key) < key_distance(key, b.key);
  });
  const bool near = key_distance(key, nearest->key) <= std::max<std::size_t>(2, name_of(key).size() / 3);
  if (!near) {
    return {};
  }
  return nearest->key;
}

}  // namespace odoless
