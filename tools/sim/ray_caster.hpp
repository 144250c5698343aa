#pragma once

#include "tools/sim/world.hpp"

namespace odoless {

/// Distance from `origin` along the unit vector `direction` (both in the world frame) to the first surface, exact but
/// for rounding; infinity where there is none. A surface seen edge-on is not seen. Linear in the world's surfaces.
[[nodiscard]] double cast_ray_m(const World& world, const Point2& origin, const Point2& direction);

}  // namespace odoless
