#include "tools/log/tilt_log.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <iterator>
#include <numbers>

#include "core/base/float_precision.hpp"
#include "tools/command/error.hpp"
#include "tools/log/fields.hpp"

namespace odoless {
namespace {

constexpr const char* kLayout =
    "t,servo stamp,servo angle,scan stamp,angle_min,angle_max,angle_inc,time_inc,rmin,rmax,n, n ranges";
constexpr std::size_t kHead = 11;
constexpr double kRadPerDeg = std::numbers::pi / 180.0;

struct Row {
  ServoAngle angle;
  LogScan scan;
};

/// Stamps that can be taken from one another, and moved by what such a difference is.
std::int64_t stamp_ns(const Fields& fields, std::size_t index) {
  constexpr std::int64_t kFarthest_ns = 3'000'000'000'000'000'000;
  const std::int64_t stamp_ns = fields.stamp_ns(index);
  if (stamp_ns < -kFarthest_ns || stamp_ns > kFarthest_ns) {
    fields.fail(fmt::format("field {} is a stamp of {:.3g} s", index + 1, static_cast<double>(stamp_ns) * 1e-9),
                "at most 3e9 s from 0");
  }
  return stamp_ns;
}

ServoAngle parse_angle(const Fields& fields) {
  const ServoAngle angle{stamp_ns(fields, 1), fields.number(2, "the servo's angle") * kRadPerDeg};
  if (!std::isfinite(angle.angle_rad)) {
    fields.fail("the servo's angle is endless", "degrees");
  }
  return angle;
}

std::int64_t beam_period_ns(const Fields& fields) {
  const double beam_period_s = fields.number(7, "time_inc");
  if (beam_period_s < 0.0 || beam_period_s > 1.0) {
    fields.fail(fmt::format("time_inc is {} s", beam_period_s), "0 (unknown) to 1 s");
  }
  return std::llround(beam_period_s * 1e9);
}

LogScan parse_scan(const Fields& fields, std::size_t beams) {
  LogScan scan{.stamp_ns = stamp_ns(fields, 3),
               .start_angle_rad = to_float_precision(fields.number(4, "angle_min")),
               .angle_step_rad = to_float_precision(fields.number(6, "angle_inc")),
               .beam_period_ns = beam_period_ns(fields),
               .ranges_m = fields.ranges_m(kHead, beams)};
  if (scan.angle_step_rad == 0.0 || !std::isfinite(scan.start_angle_rad) || !std::isfinite(scan.angle_step_rad)) {
    fields.fail("angle_inc is 0, or an angle is endless", "radians");
  }
  return scan;
}

Row parse_row(const Fields& fields) {
  fields.require(kHead, kLayout);
  const std::size_t beams = fields.count(kHead - 1, Fields::kRangesMax, "the number of ranges");
  if (fields.size() < kHead + beams) {
    fields.fail(fmt::format("{} fields do not fit {} ranges", fields.size(), beams), kLayout);
  }
  Row row{.angle = parse_angle(fields), .scan = {}};
  if (beams > 0) {
    row.scan = parse_scan(fields, beams);
  }
  return row;
}

template <class Stamped>
bool by_stamp(const Stamped& a, const Stamped& b) {
  return a.stamp_ns < b.stamp_ns;
}

void add(Row row, TiltLog& log, std::vector<std::int64_t>& differences_ns) {
  log.angles.push_back(row.angle);
  if (row.scan.ranges_m.empty()) {
    ++log.empty_rows;
    return;
  }
  differences_ns.push_back(row.angle.stamp_ns - row.scan.stamp_ns);
  if (!log.scans.empty() && row.scan.stamp_ns <= log.scans.back().stamp_ns) {
    ++log.doubled_scans;
    return;
  }
  log.scans.push_back(std::move(row.scan));
}

bool starts_as_row(std::string_view line) {
  std::size_t begin = 0;
  for (std::size_t field = 0; field + 1 < kHead; ++field) {
    begin = line.find(',', begin);
    if (begin == std::string_view::npos) {
      return false;
    }
    ++begin;
  }
  const std::string_view rest = line.substr(begin, line.find(',', begin) - begin);
  std::ptrdiff_t beams = 0;
  const auto parsed = std::from_chars(rest.data(), rest.data() + rest.size(), beams);
  return parsed.ec == std::errc{} && parsed.ptr == rest.data() + rest.size() &&
         std::count(line.begin(), line.end(), ',') == static_cast<std::ptrdiff_t>(kHead) - 1 + beams;
}

void append_row(std::string& text, const ServoAngle& angle, const LogScan& scan) {
  constexpr double kRangeMinM = 0.05;
  constexpr double kRangeMaxM = 100.0;
  const double last_rad = scan.start_angle_rad + scan.angle_step_rad * static_cast<double>(scan.ranges_m.size() - 1);
  const auto to_s = [](std::int64_t stamp_ns) { return static_cast<double>(stamp_ns) * 1e-9; };
  fmt::format_to(std::back_inserter(text), "{:.6f},{:.6f},{:.6f},{:.6f},{:.9f},{:.9f},{:.9f},{:.9f},{:.3f},{:.3f},{}",
                 to_s(scan.stamp_ns), to_s(angle.stamp_ns), angle.angle_rad / kRadPerDeg, to_s(scan.stamp_ns),
                 scan.start_angle_rad, last_rad, scan.angle_step_rad, to_s(scan.beam_period_ns), kRangeMinM, kRangeMaxM,
                 scan.ranges_m.size());
  for (const float range_m : scan.ranges_m) {
    fmt::format_to(std::back_inserter(text), ",{:.3f}", std::isfinite(range_m) ? range_m : 0.0F);
  }
  text += '\n';
}

}  // namespace

TiltLog read_tilt_log(LineReader& lines) {
  TiltLog log;
  Fields fields;
  std::vector<std::int64_t> differences_ns;
  std::string_view line;
  while (lines.next(line)) {
    if (!line.empty() && line.front() != '#') {
      fields.split(line, lines, ',');
      Row row = parse_row(fields);
      lines.keep(sizeof(ServoAngle) + sizeof(LogScan) + sizeof(float) * row.scan.ranges_m.size());
      add(std::move(row), log, differences_ns);
    }
  }
  std::stable_sort(log.angles.begin(), log.angles.end(), by_stamp<ServoAngle>);
  const auto same = [](const ServoAngle& a, const ServoAngle& b) { return a.stamp_ns == b.stamp_ns; };
  log.angles.erase(std::unique(log.angles.begin(), log.angles.end(), same), log.angles.end());
  if (log.scans.size() < 2 || log.angles.size() < 2) {
    throw DataError(lines.name(), 0, fmt::format("{} scans and {} angles", log.scans.size(), log.angles.size()),
                    "two or more of each");
  }
  const auto middle = differences_ns.begin() + static_cast<std::ptrdiff_t>(differences_ns.size() / 2);
  std::nth_element(differences_ns.begin(), middle, differences_ns.end());
  log.row_offset_ns = *middle;
  return log;
}

TiltLog read_tilt_log(const std::filesystem::path& path) {
  LineReader lines(open_bytes(path), path.string());
  return read_tilt_log(lines);
}

bool is_tilt_log(const std::filesystem::path& path) {
  LineReader lines(open_bytes(path), path.string());
  std::string_view line;
  bool found = lines.next(line);
  while (found && (line.empty() || line.front() == '#')) {
    found = lines.next(line);
  }
  return found && starts_as_row(line);
}

std::string tilt_csv(const TiltLog& log, std::int64_t servo_ahead_ns) {
  std::string text;
  for (const LogScan& scan : log.scans) {
    const auto later = std::lower_bound(log.angles.begin(), log.angles.end(),
                                        ServoAngle{scan.stamp_ns + servo_ahead_ns, 0.0}, by_stamp<ServoAngle>);
    append_row(text, later == log.angles.end() ? log.angles.back() : *later, scan);
  }
  return text;
}

}  // namespace odoless
