#include "drivers/lrf/csv/scan_line.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <numbers>
#include <system_error>

namespace odoless::csv {
namespace {

constexpr std::string_view kHead = "scan";
constexpr double kTurnRad = 2.0 * std::numbers::pi;
constexpr double kStepMinRad = 1e-5;
constexpr double kStepMaxRad = 0.5;
constexpr double kStampMaxS = 1e11;
constexpr double kSweepMaxS = 2.0;
constexpr float kRangeMaxM = 10'000.0F;

/// Takes a value and its comma off the front.
std::string_view take_value(std::string_view& rest) {
  const std::size_t comma = rest.find(',');
  const std::string_view value = rest.substr(0, comma);
  rest.remove_prefix(comma == std::string_view::npos ? rest.size() : comma + 1);
  return value;
}

/// The whole of `text` as a number, or nothing. It may be infinite or not a number.
template <class Number>
std::optional<Number> number_of(std::string_view text) {
  Number number{};
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, number);
  return error == std::errc() && stop == end && !text.empty() ? std::optional(number) : std::nullopt;
}

bool is_possible(const ScanShape& shape) {
  const double step_rad = std::abs(shape.angle_step_rad);
  return shape.beams >= 2 && std::abs(shape.start_angle_rad) <= kTurnRad && step_rad >= kStepMinRad &&
         step_rad <= kStepMaxRad && step_rad * (shape.beams - 1) <= kTurnRad && shape.beam_period_s >= 0.0 &&
         shape.beam_period_s * shape.beams <= kSweepMaxS;
}

/// @return  False: it is no range.
bool read_range(std::string_view text, float& range_m) {
  const std::optional<float> number = text.empty() ? 0.0F : number_of<float>(text);
  if (!number || *number == -std::numeric_limits<float>::infinity()) {
    return false;
  }
  range_m = *number > 0.0F ? *number : 0.0F;  // nan is not
  return range_m <= kRangeMaxM || std::isinf(range_m);
}

}  // namespace

Result<ScanLine> scan_line_of(std::string_view line, std::span<float> ranges_m) {
  if (line.ends_with('\r')) {
    line.remove_suffix(1);
  }
  if (take_value(line) != kHead) {
    return Errc::kFrameMalformed;
  }
  ScanLine scan;
  const std::string_view stamp = take_value(line);
  const std::optional<double> stamp_s = number_of<double>(stamp);
  const std::optional<double> start_rad = number_of<double>(take_value(line));
  const std::optional<double> step_rad = number_of<double>(take_value(line));
  const std::string_view period = take_value(line);
  const std::optional<double> period_s = period.empty() ? 0.0 : number_of<double>(period);
  if ((!stamp.empty() && !stamp_s) || !start_rad || !step_rad || !period_s) {
    return Errc::kFrameMalformed;
  }
  scan.stamp_s = stamp_s;
  scan.shape = {0, *start_rad, *step_rad, *period_s};
  for (bool is_more = true; is_more; ++scan.shape.beams) {
    if (static_cast<std::size_t>(scan.shape.beams) == ranges_m.size()) {
      return Errc::kTooManyBeams;
    }
    is_more = line.find(',') != std::string_view::npos;
    if (!read_range(take_value(line), ranges_m[static_cast<std::size_t>(scan.shape.beams)])) {
      return Errc::kFrameMalformed;
    }
  }
  const bool is_time = !stamp_s || (*stamp_s >= 0.0 && *stamp_s <= kStampMaxS);
  return is_possible(scan.shape) && is_time ? Result<ScanLine>(scan) : Result<ScanLine>(Errc::kBadGeometry);
}

LineReader::Outcome LineReader::take(std::span<const std::byte>& bytes) {
  const auto end = std::find(bytes.begin(), bytes.end(), std::byte{'\n'});
  const auto count = static_cast<std::size_t>(end - bytes.begin());
  const bool is_too_long = count > bytes_.size() - std::min(size_, bytes_.size()) || size_ > bytes_.size();
  if (!is_too_long) {
    std::transform(bytes.begin(), end, bytes_.begin() + static_cast<std::ptrdiff_t>(size_),
                   [](std::byte b) { return static_cast<char>(b); });
  }
  size_ = is_too_long ? bytes_.size() + 1 : size_ + count;
  const bool is_complete = end != bytes.end();
  bytes = bytes.subspan(is_complete ? count + 1 : count);
  if (!is_complete) {
    return Outcome::kMore;
  }
  done_bytes_ = is_too_long ? 0 : size_;
  size_ = 0;
  return is_too_long ? Outcome::kSkipped : Outcome::kLine;
}

}  // namespace odoless::csv
