#include "core/graph/place_fit.hpp"

#include <algorithm>
#include <cmath>

#include "core/math/elementary.hpp"

namespace odoless {
namespace {

constexpr double kCell_m = 0.1;
constexpr double kHalf_m = 0.5 * kCell_m * MapPiece::kSide_cells;
constexpr Pose2 kMap_T_piece{kHalf_m, kHalf_m, 0.0};
constexpr std::uint32_t kWallPasses = 3;   // beams that go through a wall's cell for one that ends there
constexpr std::uint32_t kFreePasses = 10;  // from which on it is free
constexpr int kNear_cells = 2;             // of a wall
constexpr double kStep_m = 0.07;
constexpr double kFrom_m = 0.3;
constexpr double kClear_m = 0.5;  // before a return; a wall there may be the one that it lies on

bool is_wall(const Cell& cell) {
  return cell.hits() * kWallPasses * Cell::kParts >= cell.way_parts() && cell.hits() > 0;
}
bool is_free(const Cell& cell) {
  return !cell.is_unknown() && cell.hits() * kFreePasses * Cell::kParts < cell.way_parts();
}

ScanParams of_keyframes(ScanParams scan, int keyframe_beams_max) {
  scan.beams_max = std::max(keyframe_beams_max, 8);
  return scan;
}

}  // namespace

PlaceFit::PlaceFit(const ScanParams& scan, int keyframe_beams_max)
    : frame_(of_keyframes(scan, keyframe_beams_max)), beams_({}, kCell_m), map_(kCell_m) {}

void PlaceFit::draw(const SubmapWorld& world, int submap, const Pose2& submap_T_piece) {
  map_.begin({0, 0});
  const auto draw_one = [&](int each) {
    const Submap& drawn = world.submaps[static_cast<std::size_t>(each)];
    const Pose2 map_T_drawn = kMap_T_piece * submap_T_piece.inverse() * world.graph.between(submap, each);
    for (int k = drawn.first_keyframe; k < drawn.end_keyframe(); ++k) {
      const PlacedKeyframe placed{k, map_T_drawn * world.store.submap_T_scan(k), 2.0 * kHalf_m};
      static_cast<void>(map_.add(world.store, placed, beams_, frame_));
    }
  };
  draw_one(submap);
  for_each_neighbour(world.graph, submap, draw_one);
}

const Cell* PlaceFit::cell(const Point2& p) const {
  const double column = std::floor(p.x_m / kCell_m);
  const double row = std::floor(p.y_m / kCell_m);
  const bool is_inside = std::min(column, row) >= 0.0 && std::max(column, row) < MapPiece::kSide_cells;
  return is_inside ? &map_.cell(static_cast<int>(column), static_cast<int>(row)) : nullptr;
}

bool PlaceFit::is_near_wall(const Point2& p) const {
  for (int row = -kNear_cells; row <= kNear_cells; ++row) {
    for (int column = -kNear_cells; column <= kNear_cells; ++column) {
      const Cell* const at = cell({p.x_m + column * kCell_m, p.y_m + row * kCell_m});
      if (at != nullptr && row * row + column * column <= kNear_cells * kNear_cells && is_wall(*at)) {
        return true;
      }
    }
  }
  return false;
}

void PlaceFit::count(const Pose2& map_T_scan, Tally& tally) const {
  const auto [s, c] = math::sincos(map_T_scan.yaw_rad);
  for (int beam = 0; beam < frame_.size(); ++beam) {
    const Cell* const end = frame_.is_return(beam) ? cell(map_T_scan * frame_.point(beam)) : nullptr;
    if (end == nullptr) {
      continue;
    }
    const Point2 d = frame_.direction(beam);
    const Point2 way{c * d.x_m - s * d.y_m, s * d.x_m + c * d.y_m};
    bool is_through = false;
    double at_m = kFrom_m - kStep_m;
    while ((at_m += kStep_m) < frame_.range_m(beam) - kClear_m && !is_through) {
      const Cell* const at = cell({map_T_scan.x_m + at_m * way.x_m, map_T_scan.y_m + at_m * way.y_m});
      is_through = at != nullptr && is_wall(*at);
    }
    const bool is_explained = !is_through && is_near_wall(map_T_scan * frame_.point(beam));
    tally.explained += is_explained ? 1 : 0;
    tally.contradicted += is_through || (!is_explained && is_free(*end)) ? 1 : 0;
  }
}

double PlaceFit::explained(const SubmapWorld& world, int submap, std::span<const PathScan> piece,
                           const Pose2& submap_T_piece) {
  draw(world, submap, submap_T_piece);
  Tally tally;
  for (const PathScan& each : piece) {
    world.store.load(each.keyframe, 1, frame_);
    count(kMap_T_piece * each.piece_T_scan, tally);
  }
  return static_cast<double>(tally.explained) / std::max(1, tally.explained + tally.contradicted);
}

}  // namespace odoless
