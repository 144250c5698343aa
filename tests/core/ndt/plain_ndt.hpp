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
    std::map<Key, std::vector<Point2>> cells;
    for (int i = 0; i < points.size(); ++i) {
      for (int grid = 0; grid < Ndt::kGrids; ++grid) {
        cells[key(grid, points[i])].push_back(points[i]);
      }
    }
    for (const auto& [cell, inside] : cells) {
      if (static_cast<int>(inside.size()) >= params.points_min) {
        normals_.emplace(cell, Normal(inside, params));
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
      if (const Normal* const normal = find(grid, p)) {
        sum += normal->gaussian(p) / Ndt::kGrids;
      }
    }
    return sum;
  }

  /// NdtDerivatives::held by its definition.
  [[nodiscard]] Eigen::Matrix3d held(const PointSet& points, const Pose2& reference_T_points) const {
    Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
    for (int i = 0; i < points.size(); ++i) {
      const Point2 p = reference_T_points * points[i];
      Eigen::Matrix<double, 2, 3> jacobian;
      jacobian << 1.0, 0.0, -(p.y_m - reference_T_points.y_m), 0.0, 1.0, p.x_m - reference_T_points.x_m;
      for (int grid = 0; grid < Ndt::kGrids; ++grid) {
        if (const Normal* const normal = find(grid, p)) {
          const Eigen::Matrix2d across = normal->across * normal->across.transpose();
          const double doubt = Ndt::kAxis_sd_rad * Ndt::kAxis_sd_rad;
          const Eigen::Matrix2d information =
              (1.0 / normal->small_m2 - 1.0 / normal->large_m2) * (across - doubt * Eigen::Matrix2d::Identity());
          sum += normal->gaussian(p) / Ndt::kGrids * jacobian.transpose() * information * jacobian;
        }
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

  /// The distribution of a cell's points, mended.
  struct Normal {
    Normal(const std::vector<Point2>& points, const NdtParams& params) {
      for (const Point2& q : points) {
        mean += Eigen::Vector2d(q.x_m, q.y_m) / static_cast<double>(points.size());
      }
      Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();
      for (const Point2& q : points) {
        const Eigen::Vector2d d = Eigen::Vector2d(q.x_m, q.y_m) - mean;
        covariance += d * d.transpose() / static_cast<double>(points.size() - 1);
      }
      const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(covariance);
      const double floor_m2 = params.sigma_min_m * params.sigma_min_m;
      large_m2 = std::max(axes.eigenvalues()(1), floor_m2);
      small_m2 =
          std::max({axes.eigenvalues()(0), floor_m2, params.sigma_ratio_min * params.sigma_ratio_min * large_m2});
      across = axes.eigenvectors().col(0);
      along = axes.eigenvectors().col(1);
    }

    [[nodiscard]] double gaussian(const Point2& p) const {
      const Eigen::Vector2d d = Eigen::Vector2d(p.x_m, p.y_m) - mean;
      return std::exp(-0.5 * (std::pow(across.dot(d), 2) / small_m2 + std::pow(along.dot(d), 2) / large_m2));
    }

    Eigen::Vector2d mean = Eigen::Vector2d::Zero();
    Eigen::Vector2d across;
    Eigen::Vector2d along;
    double large_m2 = 0.0;
    double small_m2 = 0.0;
  };

  /// Of the cell that a point lies in; none if it has too few points.
  [[nodiscard]] const Normal* find(int grid, const Point2& p) const {
    const auto normal = normals_.find(key(grid, p));
    return normal == normals_.end() ? nullptr : &normal->second;
  }

  NdtParams params_;
  std::map<Key, Normal> normals_;
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
