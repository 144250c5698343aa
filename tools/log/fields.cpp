#include "tools/log/fields.hpp"

#include <fmt/core.h>

#include <charconv>
#include <cmath>

#include "tools/command/error.hpp"
#include "tools/log/stamp.hpp"

namespace odoless {
namespace {

constexpr std::string_view kBlank = " \t";
constexpr std::size_t kShownBytesMax = 24;

template <class Number>
bool parse(std::string_view text, Number& number) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  return error == std::errc() && end == text.data() + text.size();
}

std::string_view trim(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(kBlank);
  return begin == std::string_view::npos ? std::string_view()
                                         : text.substr(begin, text.find_last_not_of(kBlank) + 1 - begin);
}

/// The text as it may stand in a message: short, and printable whatever a damaged file holds.
std::string shown(std::string_view text) {
  std::string result(text.substr(0, kShownBytesMax));
  for (char& c : result) {
    c = c >= ' ' && c <= '~' ? c : '?';
  }
  return result + (text.size() > kShownBytesMax ? "..." : "");
}

}  // namespace

void Fields::split(std::string_view line, const LineReader& reader, char separator) {
  fields_.clear();
  name_ = reader.name();
  line_ = reader.number();
  line = trim(line);
  while (!line.empty()) {
    const std::size_t end = separator == ' ' ? line.find_first_of(kBlank) : line.find(separator);
    fields_.push_back(trim(line.substr(0, end)));
    if (end == std::string_view::npos) {
      return;
    }
    line.remove_prefix(end + 1);
    if (separator == ' ') {
      line = trim(line);
    } else if (line.empty()) {
      fields_.push_back(line);
    }
  }
}

double Fields::number(std::size_t index, const char* what) const {
  double value = 0.0;
  if (!parse(fields_[index], value) || !std::isfinite(value)) {
    fail_field(index, fmt::format("a finite number ({})", what));
  }
  return value;
}

float Fields::range_m(std::size_t index) const {
  float value = 0.0F;
  if (!parse(fields_[index], value)) {
    fail_field(index, "a range in metres");
  }
  return value;
}

std::size_t Fields::count(std::size_t index, std::size_t max, const char* what) const {
  std::size_t value = 0;
  if (!parse(fields_[index], value) || value > max) {
    fail_field(index, fmt::format("{}, a whole number of at most {}", what, max));
  }
  return value;
}

std::int64_t Fields::stamp_ns(std::size_t index) const {
  const std::optional<std::int64_t> stamp_ns = parse_stamp_ns(fields_[index], stamp_digits_);
  if (!stamp_ns) {
    fail_field(index, "a time stamp in seconds");
  }
  return *stamp_ns;
}

std::vector<float> Fields::ranges_m(std::size_t begin, std::size_t size) const {
  std::vector<float> ranges_m(size);
  for (std::size_t i = 0; i < size; ++i) {
    ranges_m[i] = range_m(begin + i);
  }
  return ranges_m;
}

void Fields::require(std::size_t least, const char* layout) const {
  if (fields_.size() < least) {
    fail(fmt::format("the line has {} fields only", fields_.size()), layout);
  }
}

void Fields::fail(const std::string& wrong, const std::string& right) const {
  throw DataError(name_, line_, wrong, right);
}

void Fields::fail_field(std::size_t index, const std::string& right) const {
  fail(fmt::format("field {} is '{}'", index + 1, shown(fields_[index])), right);
}

}  // namespace odoless
