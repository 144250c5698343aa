#include "core/graph/world_map.hpp"

#include <algorithm>
#include <climits>
#include <cmath>
#include <limits>
#include <set>

namespace odoless {
namespace {

constexpr double kCells_max = 1e8;  // of what is written; beyond, cells are twice as large, and so on

/// What all beams may cover.
double area_m2(std::span<const PlacedKeyframe> placed) {
  constexpr double kNone_m = std::numeric_limits<double>::infinity();
  Point2 least_m{kNone_m, kNone_m};
  Point2 most_m{-kNone_m, -kNone_m};
  for (const auto& [keyframe, pose, reach_m] : placed) {
    least_m = {std::min(least_m.x_m, pose.x_m - reach_m), std::min(least_m.y_m, pose.y_m - reach_m)};
    most_m = {std::max(most_m.x_m, pose.x_m + reach_m), std::max(most_m.y_m, pose.y_m + reach_m)};
  }
  return placed.empty() ? 0.0 : (most_m.x_m - least_m.x_m) * (most_m.y_m - least_m.y_m);
}

}  // namespace

void WorldMap::render(const SubmapWorld& world, const ScanParams& scan) {
  std::vector<PlacedKeyframe> placed;
  for_each_keyframe(world, [&](int keyframe, const Pose2& map_T_scan) {
    placed.push_back({keyframe, map_T_scan, world.store.farthest_m(keyframe)});
  });
  while (area_m2(placed) > kCells_max * resolution_m_ * resolution_m_) {
    resolution_m_ *= 2.0;
  }
  std::set<PieceIndex> pieces;
  for (const PlacedKeyframe& each : placed) {
    for_each_piece(each, resolution_m_, [&pieces](const PieceIndex& index) { pieces.insert(index); });
  }
  cover(pieces);
  ScanFrame frame(scan);
  const BeamModel model(beam_, resolution_m_);
  MapPiece piece(resolution_m_);
  for (const PieceIndex& index : pieces) {
    piece.begin(index);
    for (const PlacedKeyframe& each : placed) {
      piece.add(world.store, each, model, frame);
    }
    take(piece);
  }
  cut();
}

void WorldMap::cover(const std::set<PieceIndex>& pieces) {
  map_ = OccupancyMap{};
  map_.resolution_m = resolution_m_;
  if (pieces.empty()) {
    return;
  }
  const auto [least, most] = std::minmax_element(
      pieces.begin(), pieces.end(), [](const PieceIndex& a, const PieceIndex& b) { return a.column < b.column; });
  first_column_ = least->column * MapPiece::kSide_cells;
  first_row_ = pieces.begin()->row * MapPiece::kSide_cells;
  map_.width_cells = (most->column + 1) * MapPiece::kSide_cells - first_column_;
  map_.height_cells = (pieces.rbegin()->row + 1) * MapPiece::kSide_cells - first_row_;
  map_.occupancy_percent.assign(
      static_cast<std::size_t>(map_.width_cells) * static_cast<std::size_t>(map_.height_cells), OccupancyMap::kUnknown);
}

void WorldMap::take(const MapPiece& piece) {
  const auto rho_min_parts = static_cast<float>(beam_.rho_min_m / resolution_m_ * Cell::kParts);
  const int left = piece.index().column * MapPiece::kSide_cells - first_column_;
  const int lowest = piece.index().row * MapPiece::kSide_cells - first_row_;
  for (int row = 0; row < MapPiece::kSide_cells; ++row) {
    std::int8_t* const out =
        &map_.occupancy_percent[static_cast<std::size_t>(lowest + row) * static_cast<std::size_t>(map_.width_cells) +
                                static_cast<std::size_t>(left)];
    for (int column = 0; column < MapPiece::kSide_cells; ++column) {
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
