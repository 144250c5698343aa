#include "tools/cloud/cloud_check.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "core/math/principal_axes.hpp"

namespace odoless {
namespace {

constexpr double kFloorCellM = 0.25;
constexpr double kFloorBandM = 0.3;
constexpr float kAboveFloorM = 1.2F;
constexpr double kWallCellM = 0.5;
constexpr float kWallFromM = 0.4F;
constexpr float kWallToM = 2.0F;
constexpr float kWallHeightMinM = 1.0F;
constexpr std::size_t kWallPointsMin = 40;

using Cell = std::pair<int, int>;
using Columns = std::map<Cell, std::vector<CloudPoint>>;

/// The points of a key by the column of space in which they are.
Columns columns_of(std::span<const CloudPoint> points, double side_m) {
  Columns columns;
  for (const CloudPoint& p : points) {
    const auto index = [side_m](float value_m) { return static_cast<int>(std::floor(value_m / side_m)); };
    columns[{index(p.x_m), index(p.y_m)}].push_back(p);
  }
  return columns;
}

void add_floor(std::span<const CloudPoint> points, std::vector<double>& heights_m) {
  for (const auto& [cell, column] : columns_of(points, kFloorCellM)) {
    const bool is_free = std::none_of(column.begin(), column.end(), [](const CloudPoint& p) {
      return p.z_m > static_cast<float>(kFloorBandM) && p.z_m < kAboveFloorM;
    });
    for (const CloudPoint& p : column) {
      if (is_free && std::abs(p.z_m) <= kFloorBandM) {
        heights_m.push_back(p.z_m);
      }
    }
  }
}

struct Plane {
  Eigen::Vector3d normal;
  double thickness_m;  ///< standard deviation across
  double width_m;      ///< of its narrower side, likewise
};

Plane fit_plane(const std::vector<CloudPoint>& points) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const CloudPoint& p : points) {
    mean += Eigen::Vector3d(p.x_m, p.y_m, p.z_m) / static_cast<double>(points.size());
  }
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const CloudPoint& p : points) {
    const Eigen::Vector3d off = Eigen::Vector3d(p.x_m, p.y_m, p.z_m) - mean;
    scatter += off * off.transpose() / static_cast<double>(points.size());
  }
  const math::PrincipalAxes<3> extent = math::principal_axes<3>(scatter);
  return {extent.axes.col(0), std::sqrt(std::max(extent.values(0), 0.0)), std::sqrt(std::max(extent.values(1), 0.0))};
}

void add_walls(std::span<const CloudPoint> points, std::vector<double>& leans_rad) {
  constexpr double kThicknessMaxM = 0.04;
  constexpr double kWidthMinM = 0.1;
  constexpr double kUprightMaxRad = 0.35;
  std::vector<CloudPoint> upright;
  std::copy_if(points.begin(), points.end(), std::back_inserter(upright),
               [](const CloudPoint& p) { return p.z_m >= kWallFromM && p.z_m <= kWallToM; });
  for (const auto& [cell, column] : columns_of(upright, kWallCellM)) {
    const auto [low, high] = std::minmax_element(
        column.begin(), column.end(), [](const CloudPoint& a, const CloudPoint& b) { return a.z_m < b.z_m; });
    if (column.size() < kWallPointsMin || high->z_m - low->z_m < kWallHeightMinM) {
      continue;
    }
    const Plane plane = fit_plane(column);
    const double lean_rad = std::asin(std::min(std::abs(plane.normal.z()), 1.0));
    if (plane.thickness_m <= kThicknessMaxM && plane.width_m >= kWidthMinM && lean_rad <= kUprightMaxRad) {
      leans_rad.push_back(lean_rad);
    }
  }
}

}  // namespace

CloudCheck check_cloud(const KeyedCloud& cloud) {
  std::vector<double> heights_m;
  std::vector<double> leans_rad;
  for (std::size_t key = 0; key < cloud.keys().size(); ++key) {
    add_floor(cloud.points_of(key), heights_m);
    add_walls(cloud.points_of(key), leans_rad);
  }
  CloudCheck check;
  check.floor_height_m = summarise(heights_m).median;
  for (double& height_m : heights_m) {
    height_m = std::abs(height_m - check.floor_height_m);
  }
  check.floor_deviation_m = summarise(std::move(heights_m));
  check.wall_lean_rad = summarise(std::move(leans_rad));
  return check;
}

}  // namespace odoless
