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
constexpr char kSeparator = '&';  ///< before each echo of a beam but the first

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

/// What the characters of a line sum up to, and which they are.
struct LineLook {
  std::uint32_t sum = 0;
  std::uint32_t separators = 0;
  std::uint32_t strange = 0;  ///< neither encoded nor separators
};

/// In one pass without a branch, which compilers turn into few instructions for many characters.
LineLook look_at(std::string_view line) {
  LineLook look;
  for (const char c : line) {
    const auto byte = static_cast<std::uint8_t>(c);
    const bool separates = c == kSeparator;
    look.sum += byte;
    look.separators += separates ? 1U : 0U;
    look.strange += !separates && static_cast<std::uint8_t>(byte - 0x30U) > 0x3FU ? 1U : 0U;
  }
  return look;
}

/// The data of a reply in one piece, and how many characters of it separate echoes.
struct Data {
  std::string_view text;
  std::size_t separators = 0;
};

/// Puts the lines of data together in `room`; each is full, but for the last one.
Result<Data> data_of(const Reply& reply, const ScanFormat& format, std::span<char> room) {
  ODOLESS_CHECK(room.size() >= format.most_characters());
  Data data;
  std::size_t size = 0;
  for (int i = kDataLine; i < reply.lines(); ++i) {
    const std::string_view line = reply.line(i);
    const bool is_full = line.size() == kLineCharacters + 1;
    const bool is_end = i + 1 == reply.lines() && line.size() >= 2 && line.size() <= kLineCharacters;
    if (!(is_full || is_end) || size + line.size() - 1 > format.most_characters()) {
      return Errc::kWrongCount;
    }
    const std::string_view text = line.substr(0, line.size() - 1);
    const LineLook look = look_at(text);
    if (look.strange > 0 || !is_encoded(line.substr(text.size()))) {
      return Errc::kFrameMalformed;
    }
    if (encode(look.sum) != line.back()) {
      return Errc::kWrongSum;
    }
    data.separators += look.separators;
    std::memcpy(room.data() + size, text.data(), text.size());
    size += text.size();
  }
  data.text = {room.data(), size};
  return size < format.fewest_characters() ? Result<Data>(Errc::kWrongCount) : Result(data);
}

/// Reads ranges and, if there are, intensities, echo by echo.
class EchoReader {
 public:
  EchoReader(std::string_view data, const ScanFormat& format) : data_(data), format_(format) {}

  /// The range of the next beam. False: the data ends before it does, or it has more echoes than there can be.
  bool next(std::uint32_t& range_mm) {
    if (!next_echo(range_mm)) {
      return false;
    }
    std::uint32_t highest = intensity_;
    for (std::size_t echoes = 1; !data_.empty() && data_.front() == kSeparator; ++echoes) {
      data_.remove_prefix(1);
      ++separators_;
      std::uint32_t echo_mm = 0;
      if (echoes == kEchoesMax || !next_echo(echo_mm)) {
        return false;
      }
      if (format_.choice == EchoChoice::kStrongest ? intensity_ > highest : echo_mm > range_mm) {
        range_mm = echo_mm;
        highest = intensity_;
      }
    }
    return true;
  }

  /// Whether all was read, and a separator stood nowhere but between echoes.
  [[nodiscard]] bool is_at_end(std::size_t separators) const { return data_.empty() && separators == separators_; }

 private:
  bool next_echo(std::uint32_t& range_mm) {
    if (data_.size() < format_.width()) {
      return false;
    }
    range_mm = value(data_.data());
    if (format_.choice == EchoChoice::kStrongest) {
      intensity_ = value(data_.data() + format_.characters_per_value);
    }
    data_.remove_prefix(format_.width());
    return true;
  }

  /// With a number of characters that the compiler knows: half the time.
  [[nodiscard]] std::uint32_t value(const char* text) const {
    return format_.characters_per_value == 3 ? decode({text, 3}) : decode({text, format_.characters_per_value});
  }

  std::string_view data_;
  const ScanFormat& format_;
  std::uint32_t intensity_ = 0;
  std::size_t separators_ = 0;
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

Result<RawFrame> scan_of(const Reply& reply, const ScanFormat& format, const ScanRoom& room) {
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
  const Result<Data> data = data_of(reply, format, room.data);
  if (!data.ok()) {
    return data.error();
  }
  if (data.value().separators > 0 && format.choice == EchoChoice::kOnly) {
    return Errc::kFrameMalformed;
  }
  const std::span<std::uint32_t> ranges_mm = room.ranges_mm.first(format.beams);
  EchoReader echoes(data.value().text, format);
  for (std::uint32_t& range_mm : ranges_mm) {
    if (!echoes.next(range_mm)) {
      return Errc::kWrongCount;
    }
  }
  return echoes.is_at_end(data.value().separators) ? Result(RawFrame{stamp_ms.value(), ranges_mm})
                                                   : Result<RawFrame>(Errc::kWrongCount);
}

}  // namespace odoless::scip
