#include "tools/cloud/merged_cloud.hpp"

#include <algorithm>
#include <cmath>

namespace odoless {
namespace {

Voxel voxel_of(const Point3& point, double voxel_m) {
  const auto index = [voxel_m](double value_m) {
    constexpr double kReach = VoxelTable::kReach_voxels;
    return static_cast<std::int32_t>(std::clamp(std::floor(value_m / voxel_m), -kReach, kReach - 1.0));
  };
  return {index(point.x_m), index(point.y_m), index(point.z_m)};
}

}  // namespace

std::vector<Point3> merged_cloud(const KeyedCloud& cloud, double voxel_m) {
  VoxelTable table(static_cast<int>(std::max<std::size_t>(cloud.size(), 1)));
  std::vector<Point3> points;
  std::vector<double> returns;
  for_each_point(cloud, [&](std::size_t, const Point3& p_map, std::uint32_t count) {
    const auto number = table.find_or_add(voxel_of(p_map, voxel_m), static_cast<std::uint32_t>(points.size()));
    if (!number || *number == points.size()) {  // a table that is twice as large as needed refuses next to nothing
      points.push_back(p_map);
      returns.push_back(count);
      return;
    }
    Point3& mean = points[*number];
    returns[*number] += count;
    const double share = count / returns[*number];
    mean = {mean.x_m + share * (p_map.x_m - mean.x_m), mean.y_m + share * (p_map.y_m - mean.y_m),
            mean.z_m + share * (p_map.z_m - mean.z_m)};
  });
  return points;
}

}  // namespace odoless
