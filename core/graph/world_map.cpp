#include "core/graph/world_map.hpp"

#include <algorithm>
#include <climits>
#include <cmath>
#include <limits>

#include "core/slam/scan_beams.hpp"

namespace odoless {
namespace {

constexpr double kCells_max = 1e8;  // of what is written; beyond, cells are twice as large, and so on

/// How far a submap's beams reach from its origin.
struct Circle {
  Point2 centre_m;
  double radius_m = 0.0;
};

template <class Take>
void for_each_keyframe(const Submap& submap, const Take& take) {
  for (int k = submap.first_keyframe; k < submap.first_keyframe + submap.keyframes; ++k) {
    take(k);
  }
}

Circle circle_of(const SubmapWorld& world, int submap) {
  const Pose2& pose = world.graph.pose(submap);
  Circle circle{{pose.x_m, pose.y_m}};
  for_each_keyframe(world.submaps[static_cast<std::size_t>(submap)], [&](int k) {
    const double reach_m = world.store.submap_T_scan(k).distance_m({}) + world.store.farthest_m(k);
    circle.radius_m = std::max(circle.radius_m, reach_m);
  });
  return circle;
}

/// The part of a way, from 0 to its length, in which a coordinate that begins at `from` and changes by `slope` lies
/// within 0 and `side_cells`.
void clip(double from, double slope, double side_cells, double& begin, double& end) {
  if (slope == 0.0) {
    end = from < 0.0 || from > side_cells ? begin - 1.0 : end;
    return;
  }
  const double a = -from / slope;
  const double b = (side_cells - from) / slope;
  begin = std::max(begin, std::min(a, b));
  end = std::min(end, std::max(a, b));
}

}  // namespace

class WorldMap::Piece {
 public:
  Piece() : cells_(std::size_t{kPieceSide_cells} * kPieceSide_cells) {}

  void begin(int column, int row) {
    column_ = column;
    row_ = row;
    std::fill(cells_.begin(), cells_.end(), Cell{});
  }
  [[nodiscard]] int column() const { return column_; }
  [[nodiscard]] int row() const { return row_; }
  [[nodiscard]] const Cell& cell(int column, int row) const {
    return cells_[GridCell(column, row).index_in_tile<kPieceBits>()];
  }

  /// For BeamModel::integrate, in the piece's own cells.
  [[nodiscard]] Cell& at(const GridCell& cell) {
    if (cell.tile<kPieceBits>() == GridCell(0, 0).tile<kPieceBits>()) {
      return cells_[cell.index_in_tile<kPieceBits>()];
    }
    outside_ = Cell{};
    return outside_;
  }

  /// Adds the part of a beam that crosses the piece. Cells of the piece, from its corner.
  void add(const BeamModel& model, const Point2& start, const Point2& direction, double length_cells) {
    double begin = 0.0;
    double end = length_cells;
    clip(start.x_m, direction.x_m, kPieceSide_cells, begin, end);
    clip(start.y_m, direction.y_m, kPieceSide_cells, begin, end);
    if (begin <= end) {
      const Point2 enters{start.x_m + begin * direction.x_m, start.y_m + begin * direction.y_m};
      model.integrate(*this, GridWalk(enters, direction, end - begin), end == length_cells);
    }
  }

 private:
  int column_ = 0;
  int row_ = 0;
  std::vector<Cell> cells_;
  Cell outside_;
};

void WorldMap::render(const SubmapWorld& world, const ScanParams& scan) {
  const std::vector<Reach> reaches = find_reaches(world);
  cover(reaches);
  ScanFrame frame(scan);
  Piece piece;
  for (std::size_t i = 0; i < reaches.size();) {
    const Reach& first = reaches[i];
    piece.begin(first.column, first.row);
    for (; i < reaches.size() && reaches[i].column == piece.column() && reaches[i].row == piece.row(); ++i) {
      add(world, reaches[i].submap, frame, piece);
    }
    take(piece);
  }
  cut();
}

std::vector<WorldMap::Reach> WorldMap::find_reaches(const SubmapWorld& world) {
  constexpr double kNone_m = std::numeric_limits<double>::infinity();
  Point2 least_m{kNone_m, kNone_m};
  Point2 most_m{-kNone_m, -kNone_m};
  std::vector<Circle> circles;
  for (int i = 0; i < static_cast<int>(world.submaps.size()); ++i) {
    const Circle& circle = circles.emplace_back(circle_of(world, i));
    least_m = {std::min(least_m.x_m, circle.centre_m.x_m - circle.radius_m),
               std::min(least_m.y_m, circle.centre_m.y_m - circle.radius_m)};
    most_m = {std::max(most_m.x_m, circle.centre_m.x_m + circle.radius_m),
              std::max(most_m.y_m, circle.centre_m.y_m + circle.radius_m)};
  }
  const double area_m2 = circles.empty() ? 0.0 : (most_m.x_m - least_m.x_m) * (most_m.y_m - least_m.y_m);
  while (area_m2 > kCells_max * resolution_m_ * resolution_m_) {
    resolution_m_ *= 2.0;
  }
  const auto piece_at = [&](double x_m) {
    return static_cast<std::int32_t>(std::floor(x_m / (resolution_m_ * kPieceSide_cells)));
  };
  std::vector<Reach> reaches;
  for (std::size_t i = 0; i < circles.size(); ++i) {
    const auto& [centre_m, radius_m] = circles[i];
    for (std::int32_t row = piece_at(centre_m.y_m - radius_m); row <= piece_at(centre_m.y_m + radius_m); ++row) {
      for (std::int32_t column = piece_at(centre_m.x_m - radius_m); column <= piece_at(centre_m.x_m + radius_m);
           ++column) {
        reaches.push_back({row, column, static_cast<std::int32_t>(i)});
      }
    }
  }
  std::sort(reaches.begin(), reaches.end());
  return reaches;
}

void WorldMap::add(const SubmapWorld& world, int submap, ScanFrame& frame, Piece& piece) const {
  const BeamModel model(beam_, resolution_m_);
  for_each_keyframe(world.submaps[static_cast<std::size_t>(submap)], [&](int k) {
    const Pose2 map_T_scan = world.graph.pose(submap) * world.store.submap_T_scan(k);
    const Point2 start{map_T_scan.x_m / resolution_m_ - static_cast<double>(piece.column()) * kPieceSide_cells,
                       map_T_scan.y_m / resolution_m_ - static_cast<double>(piece.row()) * kPieceSide_cells};
    const double reach_cells = world.store.farthest_m(k) / resolution_m_;
    if (std::max(std::abs(start.x_m - kPieceSide_cells / 2), std::abs(start.y_m - kPieceSide_cells / 2)) >
        reach_cells + kPieceSide_cells / 2) {
      return;
    }
    world.store.load(k, 1, frame);
    const double cos = std::cos(map_T_scan.yaw_rad);
    const double sin = std::sin(map_T_scan.yaw_rad);
    for (int i = 0; i < frame.size(); ++i) {
      if (frame.is_return(i)) {
        const Point2 direction = frame.direction(i);
        piece.add(model, start, {cos * direction.x_m - sin * direction.y_m, sin * direction.x_m + cos * direction.y_m},
                  frame.range_m(i) / resolution_m_);
      }
    }
  });
}

void WorldMap::cover(const std::vector<Reach>& reaches) {
  map_ = OccupancyMap{};
  map_.resolution_m = resolution_m_;
  if (reaches.empty()) {
    return;
  }
  const auto [least, most] = std::minmax_element(reaches.begin(), reaches.end(),
                                                 [](const Reach& a, const Reach& b) { return a.column < b.column; });
  first_column_ = least->column * kPieceSide_cells;
  first_row_ = reaches.front().row * kPieceSide_cells;
  map_.width_cells = (most->column + 1) * kPieceSide_cells - first_column_;
  map_.height_cells = (reaches.back().row + 1) * kPieceSide_cells - first_row_;
  map_.occupancy_percent.assign(
      static_cast<std::size_t>(map_.width_cells) * static_cast<std::size_t>(map_.height_cells), OccupancyMap::kUnknown);
}

void WorldMap::take(const Piece& piece) {
  const auto rho_min_parts = static_cast<float>(beam_.rho_min_m / resolution_m_ * Cell::kParts);
  const int left = piece.column() * kPieceSide_cells - first_column_;
  const int lowest = piece.row() * kPieceSide_cells - first_row_;
  for (int row = 0; row < kPieceSide_cells; ++row) {
    std::int8_t* const out =
        &map_.occupancy_percent[static_cast<std::size_t>(lowest + row) * static_cast<std::size_t>(map_.width_cells) +
                                static_cast<std::size_t>(left)];
    for (int column = 0; column < kPieceSide_cells; ++column) {
      const Cell& cell = piece.cell(column, row);
      out[column] =
          cell.is_unknown() ? OccupancyMap::kUnknown : static_cast<std::int8_t>(cell.occupancy_percent(rho_min_parts));
    }
  }
}

void WorldMap::cut() {
  int left = INT_MAX;
  int right = 0;
  int lowest = INT_MAX;
  int highest = 0;
  for (int row = 0; row < map_.height_cells; ++row) {
    for (int column = 0; column < map_.width_cells; ++column) {
      if (map_.at(column, row) != OccupancyMap::kUnknown) {
        left = std::min(left, column);
        right = std::max(right, column + 1);
        lowest = std::min(lowest, row);
        highest = row + 1;
      }
    }
  }
  if (right == 0) {
    map_ = OccupancyMap{.resolution_m = resolution_m_, .occupancy_percent = {}};
    return;
  }
  const auto width = static_cast<std::size_t>(map_.width_cells);
  auto out = map_.occupancy_percent.begin();
  for (int row = lowest; row < highest; ++row) {
    const auto from =
        map_.occupancy_percent.begin() + static_cast<std::ptrdiff_t>(static_cast<std::size_t>(row) * width) + left;
    out = std::copy(from, from + (right - left), out);
  }
  map_.occupancy_percent.erase(out, map_.occupancy_percent.end());
  map_.width_cells = right - left;
  map_.height_cells = highest - lowest;
  map_.origin_x_m = (first_column_ + left) * resolution_m_;
  map_.origin_y_m = (first_row_ + lowest) * resolution_m_;
}

}  // namespace odoless
