#pragma once

#include <vector>

#include "core/cloud/keyed_cloud.hpp"

namespace odoless {

/// The cloud in the map as its keys lie now, one point per voxel of the map: the mean of what all keys saw there.
[[nodiscard]] std::vector<Point3> merged_cloud(const KeyedCloud& cloud, double voxel_m);

}  // namespace odoless
