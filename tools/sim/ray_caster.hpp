#pragma once

#include "tools/sim/world.hpp"

namespace odoless {

/// Distance from `origin` along the unit vector `direction` (both in the world frame) to the first surface, exact but
/// for rounding; infinity where there is none. A surface seen edge-on is not seen. Linear in the world's surfaces.
/// Walkers are not there.
[[nodiscard]] double cast_ray_m(const World& world, const Point2& origin, const Point2& direction);

constexpr double kAside_m = 0.7;  ///< from the robot to the middle of a person

/// A person, who steps aside where the robot would run into them.
[[nodiscard]] Pillar aside(const Pillar& person, const Point2& robot);

/// The same with the walkers where they are at that time, aside of the robot at `origin`.
[[nodiscard]] double cast_ray_m(const World& world, double time_s, const Point2& origin, const Point2& direction);

}  // namespace odoless
