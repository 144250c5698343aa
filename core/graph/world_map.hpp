#pragma once

#include "core/graph/submap_matcher.hpp"
#include "core/grid/occupancy_map.hpp"
#include "core/slam/beam_model.hpp"

namespace odoless {

/// The occupancy grid of a world, rendered from its keyframes at the poses that their submaps have now: piece by piece,
/// each from all beams that cross it, so that a world of any size takes the memory of one piece and of the result.
///
/// Frames: map. Errors: none; of nothing known it has no cell. Not for real-time threads: it allocates.
///
/// @param beam          How beams make a map.
/// @param scan          Its ranges beyond `range_max_m` are no returns.
/// @param resolution_m  A cell's side; of a world of more than 10^8 cells it is doubled until there are fewer.
/// @return              From the lowest cell of a beam to the highest, both ways.
[[nodiscard]] OccupancyMap render_world(const SubmapWorld& world, const BeamModelParams& beam, const ScanParams& scan,
                                        double resolution_m);

}  // namespace odoless
