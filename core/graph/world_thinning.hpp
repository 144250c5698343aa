#pragma once

#include <vector>

#include "core/graph/submap_world.hpp"

namespace odoless {

/// Which submaps of a world newer ones have made needless, by their numbers: a loop closure that holds ties it to a
/// newer one, and of the ground within 6 m of where it was seen from, newer ones that stay have seen 99 %, from as
/// near. So what stands at a place is what the last visits saw there, and a robot that goes the same ways day after day
/// needs no more room than the ways do.
///
/// The newest submap of each part always stays. Frames: map. Time: linear in the beams within 6 m. Errors: none.
[[nodiscard]] std::vector<int> needless_submaps(const SubmapWorld& world);

/// Copies a world without some of its submaps. What was known of them relative to others is handed over: the
/// constraints of a submap become those of the newer one that its surest loop closure ties it to, as all lie now, with
/// covariances carried over that closure; of two loop closures between the same submaps the surer one stays. So nothing
/// moves, and no part falls apart.
///
/// @param world     All of its keyframes are in submaps. @param needless  Of needless_submaps.
/// @param store     Empty, as graph and submaps, and with room for all that stays.
void copy_without(const SubmapWorld& world, const std::vector<int>& needless, KeyframeStore& store, PoseGraph& graph,
                  std::vector<Submap>& submaps);

}  // namespace odoless
