#pragma once

#include <cstdint>

#include "core/geometry/pose2.hpp"

namespace odoless {

/// Where the laser was, and when.
struct StampedPose {
  std::int64_t stamp_ns = 0;
  Pose2 map_T_scan;
};

}  // namespace odoless
