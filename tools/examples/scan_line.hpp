#pragma once

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <vector>

#include "core/scan/scan_frame.hpp"

/// A scan as a line of text: scan,STAMP_S,START_ANGLE_RAD,ANGLE_STEP_RAD,BEAM_PERIOD_S,RANGE_M,RANGE_M,... as the laser
/// driver csv has it (drivers/lrf/csv/README.md). What is no number is no range.
struct ScanLine {
  std::vector<double> values;
  std::vector<float> ranges_m;

  explicit ScanLine(const std::string& line) {
    for (std::size_t at = line.find(','); at != std::string::npos; at = line.find(',', at + 1)) {
      char* end = nullptr;
      const double value = std::strtod(line.c_str() + at + 1, &end);
      values.push_back(end == line.c_str() + at + 1 ? NAN : value);
    }
    for (std::size_t i = 4; i < values.size(); ++i) {
      ranges_m.push_back(static_cast<float>(values[i]));
    }
  }

  [[nodiscard]] bool is_complete() const { return values.size() > 4 && std::isfinite(values[0]); }

  /// A view of this line. @return  Whether the frame has taken it.
  [[nodiscard]] bool write_to(odoless::ScanFrame& frame) const {
    return is_complete() && frame.assign({.stamp_ns = static_cast<std::int64_t>(std::llround(1e9 * values[0])),
                                          .start_angle_rad = values[1],
                                          .angle_step_rad = values[2],
                                          .ranges_m = ranges_m}) == odoless::Errc::kOk;
  }
};
