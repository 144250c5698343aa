#include "tools/log/scan_lines.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/base/float_precision.hpp"
#include "tools/log/carmen_line.hpp"
#include "tools/log/stamp.hpp"

namespace odoless {
namespace {

constexpr const char* kDpSlamLayout = "Laser n, then n ranges";
/// The laser of the DP-SLAM logs reaches 8 m and codes no return as 8.18 and more.
constexpr float kDpSlamNoReturnM = 8.0F;
constexpr const char* kCsvLayout = "t,angle_min,angle_inc,time_inc,scan_time,rmin,rmax,n, n ranges, at most one more";
constexpr std::size_t kCsvHead = 8;

bool is_message(std::string_view line, std::string_view kind) {
  return line.starts_with(kind) &&
         (line.size() == kind.size() || line[kind.size()] == ' ' || line[kind.size()] == '\t');
}

bool is_blank_or_comment(std::string_view line) {
  const std::size_t begin = line.find_first_not_of(" \t");
  return begin == std::string_view::npos || line[begin] == '#';
}

/// Numbers with commas between them.
bool is_csv(std::string_view line) {
  const std::size_t comma = line.find(',');
  return comma != std::string_view::npos && comma > 0 &&
         line.substr(0, comma).find_first_not_of("0123456789.+-eE \t") == std::string_view::npos;
}

/// With the precision of a planar_lidar_t, whose angles are floats.
LineScan make(const Fields& fields, const CarmenLine& line) {
  LineScan result;
  result.has_stamp = line.stamp.has_value();
  result.scan = {.stamp_ns = line.stamp ? to_message_precision(fields.stamp_ns(*line.stamp)) : 0,
                 .start_angle_rad = to_float_precision(line.start_angle_rad),
                 .angle_step_rad = to_float_precision(line.angle_step_rad),
                 .no_return_m = line.no_return_m,
                 .ranges_m = fields.ranges_m(line.ranges_begin, line.ranges)};
  if (result.scan.angle_step_rad == 0.0) {
    fields.fail("the angle between two ranges is 0", "another one");
  }
  if (!std::isfinite(result.scan.start_angle_rad) || !std::isfinite(result.scan.angle_step_rad)) {
    fields.fail("an angle is endless", "radians");
  }
  return result;
}

LineScan parse_flaser(const Fields& fields) { return make(fields, lay_out_flaser(fields)); }

LineScan parse_robotlaser(const Fields& fields) { return make(fields, lay_out_robotlaser(fields)); }

LineScan parse_dpslam(const Fields& fields) {
  fields.require(3, kDpSlamLayout);
  CarmenLine line{.ranges_begin = 2, .ranges = fields.count(1, Fields::kRangesMax, "the number of ranges")};
  if (line.ranges == 0 || fields.size() != line.ranges_begin + line.ranges) {
    fields.fail(fmt::format("{} fields do not fit {} ranges", fields.size(), line.ranges), kDpSlamLayout);
  }
  line.start_angle_rad = -std::numbers::pi / 2.0;
  line.angle_step_rad = std::numbers::pi / static_cast<double>(std::max<std::size_t>(line.ranges - 1, 1));
  line.no_return_m = kDpSlamNoReturnM;
  return make(fields, line);
}

LineScan parse_csv(const Fields& fields) {
  fields.require(kCsvHead + 1, kCsvLayout);
  CarmenLine line{.ranges_begin = kCsvHead,
                  .ranges = fields.count(kCsvHead - 1, Fields::kRangesMax, "the number of ranges")};
  const std::size_t end = kCsvHead + line.ranges;
  if (line.ranges == 0 || (fields.size() != end && fields.size() != end + 1)) {
    fields.fail(fmt::format("{} fields do not fit {} ranges", fields.size(), line.ranges), kCsvLayout);
  }
  line.stamp = 0;
  line.start_angle_rad = fields.number(1, "angle_min");
  line.angle_step_rad = fields.number(2, "angle_inc");
  line.no_return_m = fields.range_m(6);
  if (!(line.no_return_m > 0.0F)) {
    fields.fail("rmax, field 7, is not above 0", "the laser's largest range in metres");
  }
  LineScan result = make(fields, line);
  result.scan.beam_period_ns = to_beam_period_ns(fields.number(3, "time_inc"));
  return result;
}

bool skip_any(std::string_view) { return true; }

constexpr std::array<ScanFormat, 4> kScanFormats{{
    {"CARMEN FLASER", ' ', [](std::string_view line) { return is_message(line, "FLASER"); }, skip_any, parse_flaser},
    {"CARMEN ROBOTLASER1", ' ', [](std::string_view line) { return is_message(line, "ROBOTLASER1"); }, skip_any,
     parse_robotlaser},
    {"DP-SLAM", ' ', [](std::string_view line) { return is_message(line, "Laser"); },
     [](std::string_view line) { return is_message(line, "Odometry") || is_blank_or_comment(line); }, parse_dpslam},
    {"handheld CSV", ',', is_csv, is_blank_or_comment, parse_csv},
}};

}  // namespace

const ScanFormat* find_scan_format(std::string_view line) {
  const auto* const found = std::find_if(kScanFormats.begin(), kScanFormats.end(),
                                         [&](const ScanFormat& format) { return format.is_scan(line); });
  return found == kScanFormats.end() ? nullptr : found;
}

}  // namespace odoless
