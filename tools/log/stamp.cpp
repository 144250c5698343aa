#include "tools/log/stamp.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <string>

namespace odoless {
namespace {

constexpr int kInt64Digits = 19;
constexpr int kExponentMax = 1000;

bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// digits * 10^exponent, digits without leading zeros.
struct Decimal {
  bool negative = false;
  std::string digits;
  int exponent = 0;
};

/// Takes the digits before and after the point off the front of `text`; false when there is none at all.
bool take_mantissa(std::string_view& text, Decimal& decimal) {
  bool any = false;
  bool after_point = false;
  while (!text.empty() && (is_digit(text.front()) || (text.front() == '.' && !after_point))) {
    const char c = text.front();
    text.remove_prefix(1);
    if (c == '.') {
      after_point = true;
      continue;
    }
    any = true;
    decimal.exponent -= after_point ? 1 : 0;
    if (c != '0' || !decimal.digits.empty()) {
      decimal.digits += c;
    }
  }
  return any;
}

/// Takes `e+09` and its like; an empty text is exponent 0.
bool take_exponent(std::string_view text, Decimal& decimal) {
  if (text.empty()) {
    return true;
  }
  if (text.front() != 'e' && text.front() != 'E') {
    return false;
  }
  text.remove_prefix(text.starts_with("e+") || text.starts_with("E+") ? 2 : 1);
  int exponent = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), exponent);
  decimal.exponent += std::clamp(exponent, -kExponentMax, kExponentMax);
  return error == std::errc() && end == text.data() + text.size();
}

/// Rounds to a whole number; nothing beyond 63 bits.
std::optional<std::int64_t> to_integer(Decimal decimal) {
  const auto whole = static_cast<std::int64_t>(decimal.digits.size()) + decimal.exponent;
  if (decimal.digits.empty() || whole < 0) {
    return 0;
  }
  if (whole > kInt64Digits) {
    return std::nullopt;
  }
  decimal.digits.resize(std::max(decimal.digits.size(), static_cast<std::size_t>(whole) + 1), '0');
  const bool round_up = decimal.digits[static_cast<std::size_t>(whole)] >= '5';
  std::uint64_t value = 0;
  std::from_chars(decimal.digits.data(), decimal.digits.data() + whole, value);
  value += round_up ? 1 : 0;
  if (value > static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max())) {
    return std::nullopt;
  }
  return decimal.negative ? -static_cast<std::int64_t>(value) : static_cast<std::int64_t>(value);
}

}  // namespace

std::optional<std::int64_t> parse_stamp_ns(std::string_view text, int digits) {
  Decimal decimal;
  decimal.negative = text.starts_with('-');
  text.remove_prefix(decimal.negative ? 1 : 0);
  if (!take_mantissa(text, decimal) || !take_exponent(text, decimal)) {
    return std::nullopt;
  }
  decimal.exponent += digits;
  return to_integer(std::move(decimal));
}

std::int64_t to_beam_period_ns(double time_increment_s) {
  return time_increment_s > 0.0 && time_increment_s < 1.0 ? std::llround(time_increment_s * 1e9) : 0;
}

bool stamps_are_usable(std::span<const std::int64_t> stamps_ns) {
  if (stamps_ns.empty()) {
    return false;
  }
  const bool all_equal = std::all_of(stamps_ns.begin(), stamps_ns.end(),
                                     [&](std::int64_t stamp_ns) { return stamp_ns == stamps_ns.front(); });
  return !all_equal || (stamps_ns.size() == 1 && stamps_ns.front() != 0);
}

}  // namespace odoless
