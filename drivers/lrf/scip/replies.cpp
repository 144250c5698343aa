#include "drivers/lrf/scip/replies.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstring>

#include "core/base/check.hpp"
#include "drivers/lrf/scip/number.hpp"

namespace odoless::scip {
namespace {

constexpr int kDataLine = 3;
constexpr std::size_t kLineCharacters = 64;

/// The value of a line "KEY:value;" with its sum, which leaves the semicolon out; some devices take it in.
Result<std::string_view> value_of(std::string_view line) {
  if (line.size() < 7 || line[4] != ':' || line[line.size() - 2] != ';') {
    return Errc::kFrameMalformed;
  }
  const std::string_view text = line.substr(0, line.size() - 2);
  if (checksum(text) != line.back() && !sum_matches(line)) {
    return Errc::kWrongSum;
  }
  return text.substr(5);
}

struct Key {
  std::string_view name;
  int Parameters::*member;
};

constexpr std::array<Key, 7> kKeys{{{"DMIN", &Parameters::range_min_mm},
                                    {"DMAX", &Parameters::range_max_mm},
                                    {"ARES", &Parameters::steps_per_turn},
                                    {"AMIN", &Parameters::first_step},
                                    {"AMAX", &Parameters::last_step},
                                    {"AFRT", &Parameters::front_step},
                                    {"SCAN", &Parameters::turns_per_minute}}};

Errc read_number(std::string_view value, int& number) {
  const auto [end, error] = std::from_chars(value.data(), value.data() + value.size(), number);
  return error == std::errc{} && end == value.data() + value.size() ? Errc::kOk : Errc::kFrameMalformed;
}

/// Reads the line into `parameters` if it is one of the keys; `found` has a bit for each.
Errc read_line(std::string_view line, Parameters& parameters, unsigned& found) {
  const Result<std::string_view> value = value_of(line);
  if (!value.ok()) {
    return value.error();
  }
  const std::string_view name = line.substr(0, 4);
  if (name == "MODL") {
    parameters.is_urg = value.value().starts_with("URG") || value.value().starts_with("UBG");
    return Errc::kOk;
  }
  for (std::size_t i = 0; i < kKeys.size(); ++i) {
    if (kKeys[i].name == name) {
      found |= 1U << i;
      return read_number(value.value(), parameters.*kKeys[i].member);
    }
  }
  return Errc::kOk;
}

bool can_be(const Parameters& p) {
  return p.range_min_mm >= 0 && p.range_max_mm > p.range_min_mm && p.range_max_mm < 1 << 18 && p.steps_per_turn >= 4 &&
         p.steps_per_turn <= 100'000 && p.first_step >= 0 && p.last_step > p.first_step &&
         p.last_step - p.first_step < p.steps_per_turn && p.last_step <= 9999 && p.front_step >= 0 &&
         p.front_step <= p.last_step && p.turns_per_minute >= 10 && p.turns_per_minute <= 60'000;
}

/// Each line of data is full, but for the last one.
Errc check_data_lines(const Reply& reply, std::size_t characters) {
  const auto lines = static_cast<int>((characters + kLineCharacters - 1) / kLineCharacters);
  if (reply.lines() != kDataLine + lines) {
    return Errc::kWrongCount;
  }
  for (int i = 0; i < lines; ++i) {
    const std::string_view line = reply.line(kDataLine + i);
    const std::size_t expected = std::min(kLineCharacters, characters - static_cast<std::size_t>(i) * kLineCharacters);
    if (line.size() != expected + 1) {
      return Errc::kWrongCount;
    }
    if (!is_encoded(line)) {
      return Errc::kFrameMalformed;
    }
    if (!sum_matches(line)) {
      return Errc::kWrongSum;
    }
  }
  return Errc::kOk;
}

/// Reads one value after the other across the ends of lines.
class ValueReader {
 public:
  explicit ValueReader(const Reply& reply) : reply_(reply) { next_line(); }

  std::uint32_t next(std::size_t characters) {
    if (line_.size() >= characters) {
      const std::uint32_t value = decode(line_.substr(0, characters));
      line_.remove_prefix(characters);
      return value;
    }
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < characters; ++i) {
      if (line_.empty()) {
        next_line();
      }
      value = (value << 6U) | decode(line_.substr(0, 1));
      line_.remove_prefix(1);
    }
    return value;
  }

 private:
  void next_line() {
    line_ = reply_.line(index_++);
    ODOLESS_CHECK(line_.size() >= 2);
    line_.remove_suffix(1);
  }

  const Reply& reply_;
  int index_ = kDataLine;
  std::string_view line_;
};

bool is_status_character(char c) { return (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z'); }

Result<std::uint32_t> stamp_of(const Reply& reply) {
  const std::string_view line = reply.line(2);
  if (line.size() != 5 || !is_encoded(line)) {
    return line.empty() ? Errc::kFrameTruncated : Errc::kFrameMalformed;
  }
  if (!sum_matches(line)) {
    return Errc::kWrongSum;
  }
  return decode(line.substr(0, 4));
}

}  // namespace

Result<Status> status_of(const Reply& reply) {
  const std::string_view line = reply.line(1);
  if (line.size() != 3) {
    return line.empty() ? Errc::kFrameTruncated : Errc::kFrameMalformed;
  }
  if (!sum_matches(line)) {
    return Errc::kWrongSum;
  }
  // The sum doesn't see the two highest bits.
  if (!is_status_character(line[0]) || !is_status_character(line[1])) {
    return Errc::kFrameMalformed;
  }
  return line[0] * 256 + line[1];
}

bool is_scip1(const Reply& reply) { return reply.lines() == 2 && reply.line(1).size() == 1; }

Result<Parameters> parameters_of(const Reply& reply) {
  const Result<Status> answer = status_of(reply);
  if (!answer.ok()) {
    return answer.error();
  }
  if (answer.value() != status("00")) {
    return Errc::kDeviceStatus;
  }
  Parameters parameters;
  unsigned found = 0;
  for (int i = 2; i < reply.lines(); ++i) {
    if (const Errc error = read_line(reply.line(i), parameters, found); error != Errc::kOk) {
      return error;
    }
  }
  if (found != (1U << kKeys.size()) - 1U) {
    return Errc::kFrameTruncated;
  }
  return can_be(parameters) ? Result(parameters) : Errc::kBadGeometry;
}

Result<RawFrame> scan_of(const Reply& reply, const ScanFormat& format, std::span<std::uint32_t> ranges_mm) {
  if (reply.line(0) != format.echo) {
    return Errc::kWrongEcho;
  }
  const Result<Status> answer = status_of(reply);
  if (!answer.ok()) {
    return answer.error();
  }
  if (answer.value() != status("99")) {
    return Errc::kDeviceStatus;
  }
  const Result<std::uint32_t> stamp_ms = stamp_of(reply);
  if (!stamp_ms.ok()) {
    return stamp_ms.error();
  }
  const auto characters = static_cast<std::size_t>(format.characters_per_value);
  const auto beams = static_cast<std::size_t>(format.beams);
  if (const Errc error = check_data_lines(reply, characters * static_cast<std::size_t>(format.values_per_beam) * beams);
      error != Errc::kOk) {
    return error;
  }
  ValueReader values(reply);
  for (std::size_t i = 0; i < beams; ++i) {
    ranges_mm[i] = values.next(characters);
    for (int extra = 1; extra < format.values_per_beam; ++extra) {
      static_cast<void>(values.next(characters));
    }
  }
  return RawFrame{stamp_ms.value(), ranges_mm.first(beams)};
}

}  // namespace odoless::scip
