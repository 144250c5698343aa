#pragma once

#include <span>
#include <vector>

#include "core/geometry/pose2.hpp"
#include "tools/log/reference_poses.hpp"

namespace odoless {

/// A place of Figure 5.8.
struct Place {
  char letter;
  Point2 position;  ///< world frame of rooms.world
};

/// The places of rooms.world, A to D.
[[nodiscard]] std::span<const Place> rooms_places();

/// The robot at a place.
struct Arrival {
  char letter = '?';
  std::size_t index = 0;  ///< of the pose that is nearest
};

/// When the poses come within 0.3 m of a place, in their order; each stay counts once.
[[nodiscard]] std::vector<Arrival> arrivals(std::span<const ReferencePose> poses, std::span<const Place> places);

}  // namespace odoless
