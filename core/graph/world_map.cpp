#include "core/graph/world_map.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <vector>

#include "core/graph/map_piece.hpp"

namespace odoless {
namespace {

constexpr double kCells_max = 1e8;  // of what is written; beyond, cells are twice as large, and so on

/// What beams go over.
class Extent {
 public:
  void add(const Pose2& map_T_scan, const ScanFrame& frame) {
    for (int i = 0; i < frame.size(); ++i) {
      if (frame.is_return(i)) {
        add({map_T_scan.x_m, map_T_scan.y_m});
        add(map_T_scan * frame.point(i));
      }
    }
  }

  /// None, if there was no beam.
  [[nodiscard]] OccupancyMap cells(double resolution_m) const {
    OccupancyMap map{.resolution_m = resolution_m, .occupancy_percent = {}};
    if (least_m_.x_m > most_m_.x_m) {
      return map;
    }
    while ((most_m_.x_m - least_m_.x_m) * (most_m_.y_m - least_m_.y_m) >
           kCells_max * map.resolution_m * map.resolution_m) {
      map.resolution_m *= 2.0;
    }
    const auto cell = [&map](double x_m) { return std::floor(x_m / map.resolution_m); };
    map.origin_x_m = cell(least_m_.x_m) * map.resolution_m;
    map.origin_y_m = cell(least_m_.y_m) * map.resolution_m;
    map.width_cells = static_cast<int>(cell(most_m_.x_m) - cell(least_m_.x_m)) + 1;
    map.height_cells = static_cast<int>(cell(most_m_.y_m) - cell(least_m_.y_m)) + 1;
    map.occupancy_percent.assign(static_cast<std::size_t>(map.width_cells) * static_cast<std::size_t>(map.height_cells),
                                 OccupancyMap::kUnknown);
    return map;
  }

 private:
  void add(const Point2& p_map) {
    least_m_ = {std::min(least_m_.x_m, p_map.x_m), std::min(least_m_.y_m, p_map.y_m)};
    most_m_ = {std::max(most_m_.x_m, p_map.x_m), std::max(most_m_.y_m, p_map.y_m)};
  }

  static constexpr double kNone_m = std::numeric_limits<double>::infinity();
  Point2 least_m_{kNone_m, kNone_m};
  Point2 most_m_{-kNone_m, -kNone_m};
};

void copy(const MapPiece& piece, double rho_min_m, OccupancyMap& map) {
  const auto rho_min_parts = static_cast<float>(rho_min_m / map.resolution_m * Cell::kParts);
  const auto first = [&map](std::int32_t index, double origin_m) {
    return index * MapPiece::kSide_cells - static_cast<int>(std::lround(origin_m / map.resolution_m));
  };
  const int left = first(piece.index().column, map.origin_x_m);
  const int lowest = first(piece.index().row, map.origin_y_m);
  for (int row = std::max(0, -lowest); row < std::min(MapPiece::kSide_cells, map.height_cells - lowest); ++row) {
    std::int8_t* const out = map.occupancy_percent.data() +
                             static_cast<std::size_t>(lowest + row) * static_cast<std::size_t>(map.width_cells);
    for (int column = std::max(0, -left); column < std::min(MapPiece::kSide_cells, map.width_cells - left); ++column) {
      const Cell& cell = piece.cell(column, row);
      out[left + column] =
          cell.is_unknown() ? OccupancyMap::kUnknown : static_cast<std::int8_t>(cell.occupancy_percent(rho_min_parts));
    }
  }
}

}  // namespace

OccupancyMap render_world(const SubmapWorld& world, const BeamModelParams& beam, const ScanParams& scan,
                          double resolution_m) {
  ScanFrame frame(scan);
  std::vector<PlacedKeyframe> placed;
  Extent extent;
  for_each_keyframe(world, [&](int keyframe, const Pose2& map_T_scan) {
    placed.push_back({keyframe, map_T_scan, world.store.farthest_m(keyframe)});
    world.store.load(keyframe, 1, frame);
    extent.add(map_T_scan, frame);
  });
  OccupancyMap map = extent.cells(resolution_m);
  std::set<PieceIndex> pieces;
  for (const PlacedKeyframe& each : placed) {
    for_each_piece(each, map.resolution_m, [&pieces](const PieceIndex& index) { pieces.insert(index); });
  }
  const BeamModel model(beam, map.resolution_m);
  MapPiece piece(map.resolution_m);
  for (const PieceIndex& index : pieces) {
    piece.begin(index);
    for (const PlacedKeyframe& each : placed) {
      piece.add(world.store, each, model, frame);
    }
    copy(piece, beam.rho_min_m, map);
  }
  return map;
}

}  // namespace odoless
