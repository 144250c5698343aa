#pragma once

#include <string>

#include "tools/experiment/cloud_output.hpp"
#include "tools/experiment/experiment.hpp"

namespace odoless {

/// What the dissertation says of 3D maps (section 5.4), as predicates of a run in 3D.

/// The trajectory of 2D SLAM serves to project the rest: points lie on the building's surfaces, in the middle within
/// 20 mm, 95 % within 60 mm.
[[nodiscard]] Claim projects_onto_surfaces(const std::string& figure, const std::string& stated,
                                           const CloudOutput& output);
/// The floor is flat within 20 mm, of 95 % of its points.
[[nodiscard]] Claim floor_is_flat(const std::string& figure, const CloudOutput& output);
/// The trajectory is known of most scans: the dissertation's worry is that poses are not frequent enough.
[[nodiscard]] Claim most_scans_are_mapped(const std::string& figure, const std::string& stated,
                                          const CloudOutput& output);

}  // namespace odoless
