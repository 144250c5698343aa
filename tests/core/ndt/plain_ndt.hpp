#pragma once

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <vector>

#include "core/base/rng.hpp"
#include "core/ndt/ndt.hpp"

namespace odoless {

/// The NDT as the paper says it, slowly: a map of cells with their points for each of four grids, two-pass means and
/// covariances, mending by eigenvalues. The oracle of `Ndt`.
class PlainNdt {
 public:
  PlainNdt(const NdtParams& params, const PointSet& points) : params_(params) {
    for (int i = 0; i < points.size(); ++i) {
      for (int grid = 0; grid < Ndt::kGrids; ++grid) {
        cells_[key(grid, points[i])].push_back(points[i]);
      }
    }
  }

  [[nodiscard]] double score(const PointSet& points, const Pose2& reference_T_points) const {
    double sum = 0.0;
    for (int i = 0; i < points.size(); ++i) {
      sum += point_score(reference_T_points * points[i]);
    }
    return sum;
  }

  [[nodiscard]] double point_score(const Point2& p) const {
    double sum = 0.0;
    for (int grid = 0; grid < Ndt::kGrids; ++grid) {
      const auto cell = cells_.find(key(grid, p));
      if (cell != cells_.end() && static_cast<int>(cell->second.size()) >= params_.points_min) {
        sum += gaussian(cell->second, p) / Ndt::kGrids;
      }
    }
    return sum;
  }

 private:
  using Key = std::array<int, 3>;

  [[nodiscard]] Key key(int grid, const Point2& p) const {
    const auto index = [&](double coordinate_m, bool shifted) {
      return static_cast<int>(std::floor(coordinate_m / params_.cell_size_m - (shifted ? 0.5 : 0.0)));
    };
    return {grid, index(p.x_m, grid % 2 == 1), index(p.y_m, grid / 2 == 1)};
  }

  [[nodiscard]] double gaussian(const std::vector<Point2>& points, const Point2& p) const {
    Eigen::Vector2d mean = Eigen::Vector2d::Zero();
    for (const Point2& q : points) {
      mean += Eigen::Vector2d(q.x_m, q.y_m) / static_cast<double>(points.size());
    }
    Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();
    for (const Point2& q : points) {
      const Eigen::Vector2d d = Eigen::Vector2d(q.x_m, q.y_m) - mean;
      covariance += d * d.transpose() / static_cast<double>(points.size() - 1);
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(covariance);
    const double floor_m2 = params_.sigma_min_m * params_.sigma_min_m;
    const double large_m2 = std::max(axes.eigenvalues()(1), floor_m2);
    const double small_m2 =
        std::max({axes.eigenvalues()(0), floor_m2, params_.sigma_ratio_min * params_.sigma_ratio_min * large_m2});
    const Eigen::Vector2d d = axes.eigenvectors().transpose() * (Eigen::Vector2d(p.x_m, p.y_m) - mean);
    return std::exp(-0.5 * (d(0) * d(0) / small_m2 + d(1) * d(1) / large_m2));
  }

  NdtParams params_;
  std::map<Key, std::vector<Point2>> cells_;
};

/// Points anywhere in a square, some of them along lines and some in heaps, as scans have them.
[[nodiscard]] inline PointSet random_points(int count, double half_side_m, Rng& rng) {
  PointSet points(count);
  while (points.size() < count) {
    const Point2 start{rng.uniform(-half_side_m, half_side_m), rng.uniform(-half_side_m, half_side_m)};
    const double direction_rad = rng.uniform(-3.2, 3.2);
    const double spacing_m = rng.below(3) == 0 ? 0.005 : 0.08;
    for (int i = 0; i < 15 && points.size() < count; ++i) {
      points.push_back({start.x_m + i * spacing_m * std::cos(direction_rad) + 0.01 * rng.normal(),
                        start.y_m + i * spacing_m * std::sin(direction_rad) + 0.01 * rng.normal()});
    }
  }
  return points;
}

}  // namespace odoless
