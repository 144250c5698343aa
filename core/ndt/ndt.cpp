#include "core/ndt/ndt.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/math/elementary.hpp"

namespace odoless {
namespace {

// A point's share of NdtDerivatives::held, but for its weight; (rx, ry) is its lever arm.
Eigen::Matrix3d across_the_wall(const NdtInformation& b, double rx, double ry) {
  const double xx = b.xx - b.along;  // (1/small - 1/large) v v^T, v across the wall
  const double yy = b.yy - b.along;
  const double doubt = Ndt::kAxis_sd_rad * Ndt::kAxis_sd_rad * (xx + yy);
  const double axx = xx - doubt;
  const double ayy = yy - doubt;
  const double jx = -axx * ry + b.xy * rx;
  const double jy = -b.xy * ry + ayy * rx;
  Eigen::Matrix3d out;
  out << axx, b.xy, jx, b.xy, ayy, jy, jx, jy, -ry * jx + rx * jy;
  return out;
}

}  // namespace

NdtInformation mended_information(const NdtCell& cell, double sigma_min_m, double sigma_ratio_min) {
  const double mid = 0.5 * (cell.cov_xx_m2 + cell.cov_yy_m2);
  const double half_difference = 0.5 * (cell.cov_xx_m2 - cell.cov_yy_m2);
  const double radius_m2 = math::hypot(half_difference, cell.cov_xy_m2);
  const double floor_m2 = sigma_min_m * sigma_min_m;
  const double large_m2 = std::max(mid + radius_m2, floor_m2);
  const double small_m2 = std::max({mid - radius_m2, floor_m2, sigma_ratio_min * sigma_ratio_min * large_m2});
  // Unit vector (u, v) of the larger axis by the double angle.
  const double c2 = radius_m2 > 0.0 ? half_difference / radius_m2 : 1.0;
  const double s2 = radius_m2 > 0.0 ? cell.cov_xy_m2 / radius_m2 : 0.0;
  const double uu = 0.5 * (1.0 + c2);
  const double vv = 0.5 * (1.0 - c2);
  const double uv = 0.5 * s2;
  const double il = 1.0 / large_m2;
  const double is = 1.0 / small_m2;
  return {uu * il + vv * is, uv * (il - is), vv * il + uu * is, il};
}

Ndt::Ndt(const NdtParams& params, int points_max) : params_(params), inverse_cell_size_(1.0 / params.cell_size_m) {
  ODOLESS_CHECK(parameters_in_range(params) && points_max > 0);
  side_cells_ = static_cast<int>(std::ceil(2.0 * params.extent_m * inverse_cell_size_)) + 2;
  const auto slots =
      std::size_t{kGrids} * static_cast<std::size_t>(side_cells_) * static_cast<std::size_t>(side_cells_);
  touched_max_ = std::min({slots, std::size_t{kCells_max}, static_cast<std::size_t>(kGrids * points_max)});
  slot_sum_.assign(slots, kNone);
  slot_cell_.assign(slots, kNone);
  sums_.reserve(touched_max_);
  touched_.reserve(touched_max_);
  cells_max_ = std::min(touched_max_, static_cast<std::size_t>(kGrids * points_max / params.points_min));
  cells_.reserve(cells_max_);
  information_.reserve(cells_max_);
}

int Ndt::slot(int grid, double x_m, double y_m) const {
  const double shift_x = (grid & 1) != 0 ? 0.5 : 0.0;
  const double shift_y = (grid & 2) != 0 ? 0.5 : 0.0;
  const double half = 0.5 * side_cells_;
  const double column = x_m * inverse_cell_size_ + half - shift_x;
  const double row = y_m * inverse_cell_size_ + half - shift_y;
  if (!(column >= 0.0 && row >= 0.0 && column < side_cells_ && row < side_cells_)) {
    return kNone;
  }
  return (grid * side_cells_ + static_cast<int>(row)) * side_cells_ + static_cast<int>(column);
}

Point2 Ndt::slot_corner(int slot_index) const {
  const int column = slot_index % side_cells_;
  const int row = (slot_index / side_cells_) % side_cells_;
  const int grid = slot_index / (side_cells_ * side_cells_);
  const double half = 0.5 * side_cells_;
  return {(column - half + ((grid & 1) != 0 ? 0.5 : 0.0)) * params_.cell_size_m,
          (row - half + ((grid & 2) != 0 ? 0.5 : 0.0)) * params_.cell_size_m};
}

void Ndt::rebuild(const PointSet& points) {
  begin_rebuild();
  static_cast<void>(rebuild_slice(points, std::numeric_limits<int>::max()));
}

void Ndt::begin_rebuild() {
  stage_ = Stage::kForget;
  next_ = 0;
}

bool Ndt::rebuild_slice(const PointSet& points, int most) {
  const auto ended = [&](std::size_t count, auto&& step) {  // as many of a stage's steps as the slice has left
    for (; next_ < count && most > 0; ++next_, --most) {
      step(next_);
    }
    return next_ == count;
  };
  if (stage_ == Stage::kForget && ended(touched_.size(), [this](std::size_t i) { forget(touched_[i]); })) {
    touched_.clear();
    sums_.clear();
    cells_.clear();
    information_.clear();
    next_ = 0;
    stage_ = Stage::kGather;
  }
  if (stage_ == Stage::kGather &&
      ended(static_cast<std::size_t>(points.size()), [&](std::size_t i) { gather(points[static_cast<int>(i)]); })) {
    next_ = 0;
    stage_ = Stage::kFinish;
  }
  if (stage_ == Stage::kFinish && ended(touched_.size(), [this](std::size_t i) { finish(touched_[i], sums_[i]); })) {
    stage_ = Stage::kDone;
  }
  return stage_ == Stage::kDone;
}

void Ndt::forget(int slot_index) {
  slot_sum_[static_cast<std::size_t>(slot_index)] = kNone;
  slot_cell_[static_cast<std::size_t>(slot_index)] = kNone;
}

void Ndt::gather(const Point2& p) {
  for (int grid = 0; grid < kGrids; ++grid) {
    const int index = slot(grid, p.x_m, p.y_m);
    if (index == kNone) {
      continue;
    }
    std::int32_t& sum_index = slot_sum_[static_cast<std::size_t>(index)];
    if (sum_index == kNone) {
      if (touched_.size() == touched_max_) {
        continue;
      }
      sum_index = static_cast<std::int32_t>(touched_.size());
      touched_.push_back(index);
      sums_.push_back({.corner = slot_corner(index)});
    }
    Sums& sum = sums_[static_cast<std::size_t>(sum_index)];
    const double x = p.x_m - sum.corner.x_m;
    const double y = p.y_m - sum.corner.y_m;
    sum.x += x;
    sum.y += y;
    sum.xx += x * x;
    sum.xy += x * y;
    sum.yy += y * y;
    ++sum.points;
  }
}

void Ndt::finish(int slot_index, const Sums& sum) {
  if (sum.points < params_.points_min || cells_.size() == cells_max_) {
    return;
  }
  const double n = sum.points;
  const double x = sum.x / n;
  const double y = sum.y / n;
  const double scale = 1.0 / (n - 1.0);
  const NdtCell cell{{sum.corner.x_m + x, sum.corner.y_m + y},
                     (sum.xx - n * x * x) * scale,
                     (sum.xy - n * x * y) * scale,
                     (sum.yy - n * y * y) * scale,
                     sum.points};
  slot_cell_[static_cast<std::size_t>(slot_index)] = static_cast<std::int32_t>(cells_.size());
  cells_.push_back({cell, sum.corner});
  information_.push_back(mended_information(cell, params_.sigma_min_m, params_.sigma_ratio_min));
}

double Ndt::score(const PointSet& points, const Pose2& reference_T_points) const {
  const auto [s, c] = math::sincos(reference_T_points.yaw_rad);
  double sum = 0.0;
  for (int i = 0; i < points.size(); ++i) {
    const Point2 p = points[i];
    const double x = reference_T_points.x_m + c * p.x_m - s * p.y_m;
    const double y = reference_T_points.y_m + s * p.x_m + c * p.y_m;
    for (int grid = 0; grid < kGrids; ++grid) {
      const int index = slot(grid, x, y);
      const int cell = index == kNone ? kNone : slot_cell_[static_cast<std::size_t>(index)];
      if (cell == kNone) {
        continue;
      }
      const Point2& mean = cells_[static_cast<std::size_t>(cell)].cell.mean;
      const NdtInformation& b = information_[static_cast<std::size_t>(cell)];
      const double dx = x - mean.x_m;
      const double dy = y - mean.y_m;
      sum += math::exp(-0.5 * (b.xx * dx * dx + 2.0 * b.xy * dx * dy + b.yy * dy * dy));
    }
  }
  return sum / kGrids;
}

NdtDerivatives Ndt::derivatives(const PointSet& points, const Pose2& reference_T_points) const {
  const auto [s, c] = math::sincos(reference_T_points.yaw_rad);
  NdtDerivatives out;
  for (int i = 0; i < points.size(); ++i) {
    const Point2 p = points[i];
    const double rx = c * p.x_m - s * p.y_m;
    const double ry = s * p.x_m + c * p.y_m;
    const double x = reference_T_points.x_m + rx;
    const double y = reference_T_points.y_m + ry;
    for (int grid = 0; grid < kGrids; ++grid) {
      const int index = slot(grid, x, y);
      const int cell = index == kNone ? kNone : slot_cell_[static_cast<std::size_t>(index)];
      if (cell == kNone) {
        continue;
      }
      const Point2& mean = cells_[static_cast<std::size_t>(cell)].cell.mean;
      const NdtInformation& b = information_[static_cast<std::size_t>(cell)];
      const double dx = x - mean.x_m;
      const double dy = y - mean.y_m;
      const double bx = b.xx * dx + b.xy * dy;  // S^-1 d
      const double by = b.xy * dx + b.yy * dy;
      const double weight = math::exp(-0.5 * (bx * dx + by * dy)) / kGrids;
      // d moves by (1, 0, -ry) and (0, 1, rx) with (x, y, yaw).
      const Eigen::Vector3d v(bx, by, -bx * ry + by * rx);  // J^T S^-1 d
      const double jx = -b.xx * ry + b.xy * rx;
      const double jy = -b.xy * ry + b.yy * rx;
      Eigen::Matrix3d curvature;
      curvature << b.xx, b.xy, jx, b.xy, b.yy, jy, jx, jy, -ry * jx + rx * jy;
      out.score += weight;
      out.gradient -= weight * v;
      out.gauss_newton += weight * curvature;
      out.held += weight * across_the_wall(b, rx, ry);
      out.hessian += weight * (v * v.transpose() - curvature);
      out.hessian(2, 2) += weight * (bx * rx + by * ry);
    }
  }
  return out;
}

}  // namespace odoless
