#include "tools/log/candump.hpp"

#include <array>
#include <cerrno>
#include <charconv>

#include "drivers/io/candump_text.hpp"
#include "tools/command/error.hpp"
#include "tools/log/line_reader.hpp"

namespace odoless {
namespace {

constexpr std::size_t kStandardDigits = 3;
constexpr std::size_t kExtendedDigits = 8;
constexpr std::uint32_t kStandardIdMax = 0x7FF;
constexpr std::int64_t kSecondsMax = 9'000'000'000'000;

/// What is before `mark`, which must be there; the rest stays in `text`.
std::optional<std::string_view> cut(std::string_view& text, char mark) {
  const std::size_t at = text.find(mark);
  if (at == std::string_view::npos) {
    return std::nullopt;
  }
  const std::string_view before = text.substr(0, at);
  text.remove_prefix(at + 1);
  return before;
}

template <class Number>
std::optional<Number> number(std::string_view text, int base) {
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value, base);
  const bool whole = error == std::errc{} && end == text.data() + text.size();
  return whole && !text.starts_with('-') ? std::optional(value) : std::nullopt;
}

std::optional<std::int64_t> stamp_us(std::string_view text) {
  std::string_view micros = text;
  const auto seconds = cut(micros, '.');
  const auto whole_s = seconds ? number<std::int64_t>(*seconds, 10) : std::nullopt;
  const auto whole_us = micros.size() == 6 ? number<std::int64_t>(micros, 10) : std::nullopt;
  if (!whole_s || !whole_us || *whole_s > kSecondsMax) {
    return std::nullopt;
  }
  return *whole_s * 1'000'000 + *whole_us;
}

std::optional<std::uint32_t> frame_id(std::string_view text) {
  const auto id = number<std::uint32_t>(text, 16);
  if (!id || (text.size() != kStandardDigits && text.size() != kExtendedDigits)) {
    return std::nullopt;
  }
  if (text.size() == kStandardDigits) {
    return *id <= kStandardIdMax ? id : std::nullopt;
  }
  if ((*id & CanFrame::kErrorFlag) != 0) {
    return *id <= (CanFrame::kErrorFlag | CanFrame::kErrorMask) ? id : std::nullopt;
  }
  return *id <= CanFrame::kErrorMask ? std::optional(*id | CanFrame::kExtendedFlag) : std::nullopt;
}

bool read_data(std::string_view text, CanFrame& frame) {
  if (text.starts_with('R')) {
    frame.id |= CanFrame::kRemoteFlag;
    const auto size = text.size() == 1 ? std::optional(0U) : number<unsigned>(text.substr(1), 10);
    frame.size_bytes = static_cast<std::uint8_t>(size.value_or(9));
    return frame.size_bytes <= frame.data.size();
  }
  if (text.size() % 2 != 0 || text.size() > 2 * frame.data.size()) {
    return false;
  }
  frame.size_bytes = static_cast<std::uint8_t>(text.size() / 2);
  for (std::size_t i = 0; i < frame.size_bytes; ++i) {
    const auto byte = number<unsigned>(text.substr(2 * i, 2), 16);
    if (!byte) {
      return false;
    }
    frame.data[i] = static_cast<std::uint8_t>(*byte);
  }
  return true;
}

}  // namespace

std::string candump_line(const RecordedCanFrame& recorded) {
  std::array<char, kCandumpTextMax> line{};
  return std::string(candump_text(recorded.stamp_us, recorded.interface, recorded.frame, line));
}

std::optional<RecordedCanFrame> parse_candump_line(std::string_view line) {
  RecordedCanFrame recorded;
  const auto before = cut(line, '(');
  const auto stamp = cut(line, ')');
  if (!before || !before->empty() || !stamp || !line.starts_with(' ')) {
    return std::nullopt;
  }
  line.remove_prefix(1);
  const auto interface = cut(line, ' ');
  if (line.ends_with(" R") || line.ends_with(" T")) {
    line.remove_suffix(2);
  }
  const auto time_us = stamp_us(*stamp);
  const auto id_text = interface ? cut(line, '#') : std::nullopt;
  const auto id = id_text ? frame_id(*id_text) : std::nullopt;
  if (!time_us || !id || interface->empty()) {
    return std::nullopt;
  }
  recorded.stamp_us = *time_us;
  recorded.interface = *interface;
  recorded.frame.id = *id;
  return read_data(line, recorded.frame) ? std::optional(recorded) : std::nullopt;
}

std::vector<RecordedCanFrame> read_candump(const std::filesystem::path& path) {
  LineReader lines(open_bytes(path.string()), path.string());
  std::vector<RecordedCanFrame> frames;
  for (std::string_view line; lines.next(line);) {
    if (line.empty()) {
      continue;
    }
    std::optional<RecordedCanFrame> frame = parse_candump_line(line);
    if (!frame) {
      throw DataError(lines.name(), lines.number(), std::string(line.substr(0, 80)),
                      "a line of candump -L, such as (1700000000.123456) can0 181#3706000000000001");
    }
    lines.keep(sizeof(RecordedCanFrame));
    frames.push_back(*std::move(frame));
  }
  return frames;
}

CandumpWriter::CandumpWriter(const std::filesystem::path& path) : path_(path.string()), file_(path) {
  if (!file_) {
    throw CannotCreateError(path_ + ": " + system_reason(errno));
  }
}

void CandumpWriter::write(const RecordedCanFrame& recorded) {
  file_ << candump_line(recorded) << '\n' << std::flush;
  if (!file_) {
    throw IoError(path_ + ": writing failed");
  }
}

}  // namespace odoless
