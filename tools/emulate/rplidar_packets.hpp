#pragma once

#include <span>
#include <string>

#include "drivers/lrf/rplidar/capsule.hpp"

namespace odoless {

/// One sample of an emulated RPLIDAR: where its mirror was, and what was seen.
struct RplidarSample {
  double mirror_deg = 0.0;        ///< clockwise
  double compensation_deg = 0.0;  ///< by which it is past what was seen
  double range_m = 0.0;           ///< 0: nothing answered
  bool starts_turn = false;       ///< the mirror's
  bool completes_scan = false;    ///< the first one after a scan of the source
};

/// Standard scan.
[[nodiscard]] std::string rplidar_nodes(std::span<const RplidarSample> samples);

/// A capsule of as many samples as the format has, and of one more, for an ultra capsule tells its last range by that.
[[nodiscard]] std::string rplidar_capsule(const rplidar::CapsuleFormat& format, std::span<const RplidarSample> samples,
                                          bool is_first);

/// In the steps in which the express scan tells it.
[[nodiscard]] double rplidar_express_compensation_deg(double compensation_deg);

}  // namespace odoless
