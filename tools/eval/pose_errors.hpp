#pragma once

#include <cstddef>
#include <vector>

#include "core/geometry/pose2.hpp"
#include "tools/eval/statistics.hpp"

namespace odoless {

/// Size of the difference between two poses or motions.
struct PoseError {
  double translation_m = 0.0;
  double rotation_rad = 0.0;  ///< 0..pi
};

/// Of `estimate` seen from `reference`, both in the same frame.
[[nodiscard]] PoseError pose_error(const Pose2& reference, const Pose2& estimate);

struct PoseErrorStatistics {
  Statistics translation_m;
  Statistics rotation_rad;
};

[[nodiscard]] PoseErrorStatistics summarise(const std::vector<PoseError>& errors);

}  // namespace odoless
