#pragma once

#include <vector>

#include "tools/experiment/experiment.hpp"

namespace odoless {

/// 5.1 to 5.6: what population, generations and noise do to a match in the simulated building.
[[nodiscard]] std::vector<Experiment> matching_experiments(Extent extent);
/// 5.7 to 5.9: matches alone, one after the other.
[[nodiscard]] std::vector<Experiment> drift_experiments(Extent extent);
/// 5.10 to 5.18: fitness on recorded logs.
[[nodiscard]] std::vector<Experiment> recorded_matching_experiments(Extent extent);
/// 5.19 to 5.23: how matches err, and the motion model's constants.
[[nodiscard]] std::vector<Experiment> motion_experiments(Extent extent);
/// 5.24 to 5.29: DP-SLAM in simulated buildings.
[[nodiscard]] std::vector<Experiment> mapping_experiments(Extent extent);
/// Not in the dissertation: other worlds, with what is built in.
[[nodiscard]] std::vector<Experiment> world_experiments(Extent extent);
/// 5.30 to 5.33: DP-SLAM on recorded logs.
[[nodiscard]] std::vector<Experiment> recorded_mapping_experiments(Extent extent);

/// 5.34 to 5.40: 3D maps.
[[nodiscard]] std::vector<Experiment> cloud_experiments(Extent extent);

}  // namespace odoless
