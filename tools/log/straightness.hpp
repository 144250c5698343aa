#pragma once

#include <cstddef>

#include "tools/log/scan_log.hpp"

namespace odoless {

/// How straight what a log's scans see is.
struct Straightness {
  double share = 0.0;         ///< 0 to 1: of the stretches, those without curvature
  std::size_t stretches = 0;  ///< that were looked at
};

/// What people build is straight, and with another angle step than the true one it is not: a wall bends, by its
/// distance times its curvature, as 1 - 1 / factor^2 where it is met squarely.
///
/// Looks at stretches of neighbouring returns that are `stretch_rad` wide by the log's own angles, of at most 300
/// scans, with the angle step times `factor`.
[[nodiscard]] Straightness straightness(const ScanLog& log, double factor, double stretch_rad);

/// The factor by which the angle step of a log is to be multiplied for walls to be straight: 1 where nothing else is
/// clearly better, else 1/2, 2/3, 3/4, 4/3, 3/2 or 2.
[[nodiscard]] double straight_step_factor(const ScanLog& log);

}  // namespace odoless
