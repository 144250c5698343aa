#pragma once

#include <cmath>
#include <cstddef>

#include "core/cloud/keyed_cloud.hpp"
#include "tools/eval/statistics.hpp"

namespace odoless {

/// How flat the floor and how upright the walls of a cloud are: what a wrong extrinsic calibration bends.
struct CloudCheck {
  Statistics floor_deviation_m;  ///< of the floor's points from their middle height, without sign
  double floor_height_m = 0.0;   ///< its middle height; 0 where the mount's height is right
  Statistics wall_lean_rad;      ///< of pieces of wall from upright, without sign

  static constexpr double kFloorDeviation95MaxM = 0.02;
  static constexpr double kFloorHeightMaxM = 0.02;
  static constexpr double kWallLeanMeanMaxRad = 0.012;
  static constexpr std::size_t kFloorPointsMin = 200;
  static constexpr std::size_t kWallsMin = 10;

  [[nodiscard]] bool saw_enough() const {
    return floor_deviation_m.count >= kFloorPointsMin && wall_lean_rad.count >= kWallsMin;
  }
  /// Whether floor and walls are as a right calibration shows them.
  [[nodiscard]] bool is_straight() const {
    return saw_enough() && floor_deviation_m.percentile_95 <= kFloorDeviation95MaxM &&
           std::abs(floor_height_m) <= kFloorHeightMaxM && wall_lean_rad.mean <= kWallLeanMeanMaxRad;
  }
};

/// Looks at the cloud key by key, so that errors of the trajectory do not count. The floor is what lies within 0.3 m of
/// the robot's ground with nothing above it up to 1.2 m; a wall is what fills a column of 0.5 m x 0.5 m, upright by 1 m
/// and more, as a plane.
[[nodiscard]] CloudCheck check_cloud(const KeyedCloud& cloud);

}  // namespace odoless
