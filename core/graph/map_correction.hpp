#pragma once

#include <cstdint>

#include "core/geometry/pose2.hpp"

namespace odoless {

/// Why the pose graph has the robot elsewhere in the map than before.
enum class CorrectionCause : std::int8_t {
  kLoop,   ///< loop closures were accepted
  kFound,  ///< it was found where the path of this run lies in a world
};

/// A correction of where the odom frame lies in the map frame (REP 105), as it moves the robot.
struct MapCorrection {
  std::int64_t stamp_ns = 0;  ///< of the newest keyframe, which `moved` is of
  CorrectionCause cause = CorrectionCause::kLoop;
  int reference = 0;      ///< the older submap of the newest loop closure
  int query = 0;          ///< the newer one
  int loop_closures = 0;  ///< accepted since the correction before
  Pose2 moved{};          ///< from the pose in the map before to that after: along the axes of the map, and the turn
};

}  // namespace odoless
