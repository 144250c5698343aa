#include "core/match/global_search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/base/check.hpp"

namespace odoless {
namespace {

constexpr int kWall_percent = 50;
constexpr int kFree_percent = 20;
constexpr std::uint8_t kUnknown = 255;
constexpr int kSquare_evaluations = 80;  // what it costs to read a square that is known
constexpr int kCoarse_steps = 40;
constexpr int kFine_steps = 60;
constexpr SearchPoint kCoarse_size{0.15, 0.15, 0.05};
constexpr SearchPoint kFine_size{0.1, 0.1, 0.03};

RasterParams cut(RasterParams raster, const Point2& half_map_m) {
  raster.extent_m = std::clamp(std::max(half_map_m.x_m, half_map_m.y_m), 1.0, raster.extent_m);
  return raster;
}

}  // namespace

GlobalSearch::GlobalSearch(const GlobalSearchParams& params, const GridGeometry& grid, int points_max)
    : params_(params),
      half_map_m_{-grid.origin_x_m(), -grid.origin_y_m()},
      directions_(static_cast<int>(std::ceil(2.0 * std::numbers::pi / params.step_rad))),
      fine_(cut(params.fine, half_map_m_)),
      coarse_(cut(params.coarse, half_map_m_)),
      points_(points_max),
      few_points_(points_max),
      peaks_(params.peaks),
      found_(params.candidates) {
  ODOLESS_CHECK(parameters_in_range(params));
  forget_map({});
}

void GlobalSearch::forget_map(const Point2& last_p_map, const Point2& p_map_window) {
  const double x_m = std::max(0.0, half_map_m_.x_m - fine_.params().extent_m);
  const double y_m = std::max(0.0, half_map_m_.y_m - fine_.params().extent_m);
  p_map_centre_ = {std::clamp(last_p_map.x_m, p_map_window.x_m - x_m, p_map_window.x_m + x_m),
                   std::clamp(last_p_map.y_m, p_map_window.y_m - y_m, p_map_window.y_m + y_m)};
  constexpr double kFar_m = std::numeric_limits<double>::max();
  known_min_m_ = {kFar_m, kFar_m};
  known_max_m_ = {-kFar_m, -kFar_m};
  fine_.clear();
  coarse_.clear();
  phase_ = Phase::kWalls;
  next_ = 0;
}

void GlobalSearch::begin(const ScanFrame& scan) {
  ODOLESS_CHECK(has_map());
  load(scan, points_);
  few_points_.clear();
  const int every = std::max(1, (points_.size() + params_.coarse_points - 1) / params_.coarse_points);
  for (int i = 0; i < points_.size(); i += every) {
    few_points_.push_back(points_[i]);
  }
  peaks_.clear();
  found_.clear();
  next_ = 0;
  phase_ = points_.size() > 0 ? Phase::kSweep : Phase::kDone;
}

void GlobalSearch::load(const ScanFrame& scan, PointSet& points) const {
  points.clear();
  append_thinned(scan, {}, params_.thinning_m, points);
}

int GlobalSearch::work(MapSquares& map, int evaluations) {
  int spent = 0;
  while (spent < evaluations && phase_ != Phase::kIdle && phase_ != Phase::kDone) {
    if (!has_map()) {
      spent += read_square(map);
    } else {
      spent += phase_ == Phase::kSweep ? sweep_place() : climb_peak();
    }
  }
  return spent;
}

int GlobalSearch::step_evaluations_max() const {
  const int climb = (kCoarse_steps + kFine_steps) * (points_.capacity() / params_.coarse_points + 2);
  return std::max({kSquare_evaluations, directions_, climb});
}

int GlobalSearch::read_square(MapSquares& map) {
  constexpr int kSide = MapSquares::kSide_cells;
  const GridGeometry grid = map.geometry();
  const int columns = (grid.columns + kSide - 1) / kSide;
  const int rows = (grid.rows + kSide - 1) / kSide;
  const GridCell corner(grid.first_column + static_cast<int>(next_ % columns) * kSide,
                        grid.first_row + static_cast<int>(next_ / columns) * kSide);
  const bool known = map.read(corner, square_);
  if (known) {
    add(square_, corner, grid);
  }
  if (++next_ == std::int64_t{columns} * rows) {
    next_ = 0;
    phase_ = phase_ == Phase::kWalls ? Phase::kFree : Phase::kIdle;
  }
  return known ? kSquare_evaluations : 1;
}

// Walls in the first pass over the map, free space in the second: what is near a wall is not free.
void GlobalSearch::add(const MapSquares::Square& square, GridCell corner, const GridGeometry& grid) {
  for (std::size_t i = 0; i < square.size(); ++i) {
    const std::uint8_t percent = square[i];
    const int column = corner.column() + static_cast<int>(i % MapSquares::kSide_cells);
    const int row = corner.row() + static_cast<int>(i / MapSquares::kSide_cells);
    const Point2 p_map{grid.origin_x_m() + (column + 0.5) * grid.resolution_m,
                       grid.origin_y_m() + (row + 0.5) * grid.resolution_m};
    const Point2 p{p_map.x_m - p_map_centre_.x_m, p_map.y_m - p_map_centre_.y_m};
    if (phase_ == Phase::kWalls && percent != kUnknown && percent >= kWall_percent) {
      fine_.stamp(p);
      coarse_.stamp(p);
    } else if (phase_ == Phase::kFree && percent <= kFree_percent) {
      fine_.mark_free(p, params_.free_penalty);
      known_min_m_ = {std::min(known_min_m_.x_m, p_map.x_m), std::min(known_min_m_.y_m, p_map.y_m)};
      known_max_m_ = {std::max(known_max_m_.x_m, p_map.x_m), std::max(known_max_m_.y_m, p_map.y_m)};
    }
  }
}

int GlobalSearch::sweep_place() {
  const auto count = [&](double min_m, double max_m) {
    return max_m < min_m ? 0 : static_cast<std::int64_t>((max_m - min_m) / params_.step_m) + 1;
  };
  const std::int64_t columns = std::max<std::int64_t>(1, count(known_min_m_.x_m, known_max_m_.x_m));
  const std::int64_t rows = count(known_min_m_.y_m, known_max_m_.y_m);
  if (next_ >= columns * rows) {
    next_ = 0;
    phase_ = Phase::kClimb;
    return 1;
  }
  const std::int64_t row = next_ / columns;
  const std::int64_t column = next_ % columns;
  const Point2 p_map{known_min_m_.x_m + static_cast<double>(column) * params_.step_m,
                     known_min_m_.y_m + static_cast<double>(row) * params_.step_m};
  ++next_;
  if (!fine_.is_free({p_map.x_m - p_map_centre_.x_m, p_map.y_m - p_map_centre_.y_m})) {
    return 1;
  }
  for (int i = 0; i < directions_; ++i) {
    const SearchPoint pose{p_map.x_m, p_map.y_m, 2.0 * std::numbers::pi * i / directions_};
    peaks_.offer({pose, score(coarse_, few_points_, pose)});
  }
  return directions_;
}

int GlobalSearch::climb_peak() {
  if (next_ == static_cast<std::int64_t>(peaks_.poses().size())) {
    phase_ = Phase::kDone;
    return 1;
  }
  const ScoredPoint& peak = peaks_.poses()[static_cast<std::size_t>(next_++)];
  const auto coarse = [&](const SearchPoint& pose) { return score(coarse_, points_, pose); };
  const ScoredPoint near = nelder_mead({peak.point, coarse(peak.point)}, kCoarse_size, kCoarse_steps, coarse);
  found_.offer(climb(points_, near.point, kFine_steps));
  const int shares = points_.size() / std::max(1, few_points_.size()) + 1;
  return (kCoarse_steps + kFine_steps) * shares;
}

ScoredPoint GlobalSearch::climb(const PointSet& points, const SearchPoint& start, int steps) const {
  const auto fine = [&](const SearchPoint& pose) { return score(fine_, points, pose); };
  return nelder_mead({start, fine(start)}, kFine_size, steps, fine);
}

double GlobalSearch::score(const ScoreRaster& raster, const PointSet& points, const SearchPoint& pose) const {
  const Pose2 centre_T_scan{pose[0] - p_map_centre_.x_m, pose[1] - p_map_centre_.y_m, pose[2]};
  return raster.score(points.x_m(), points.y_m(), centre_T_scan) / std::max(1, points.size());
}

}  // namespace odoless
