#pragma once

#include <vector>

#include "core/graph/submap_world.hpp"

namespace odoless {

/// Of each of the first submaps, whether a robot can be told to be at it: whether it lies in a part of the world with
/// 0.8 m of way at least, or in the longest one. What a run saw that ended sooner, and that nothing ties to the rest,
/// is one place of which nobody knows whether it is another one: a robot that wakes there again and again would have
/// that many places to be at.
///
/// Time: linear in their keyframes. Errors: none.
[[nodiscard]] std::vector<bool> tell_places(const SubmapWorld& world, int submaps);

}  // namespace odoless
