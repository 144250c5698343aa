#include "core/graph/world_tiles.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace odoless {
namespace {

constexpr std::uint32_t kAllTiles = 0xFFFF;
constexpr std::uint8_t kUnknown = 255;
constexpr int kNowhere = -1;

}  // namespace

WorldTiles::WorldTiles(const BeamModelParams& beam, const ScanParams& scan, double resolution_m, int keyframes_max)
    : frame_(scan),
      model_(beam, resolution_m),
      resolution_m_(resolution_m),
      rho_min_parts_(static_cast<float>(beam.rho_min_m / resolution_m * Cell::kParts)) {
  placed_.reserve(static_cast<std::size_t>(keyframes_max));
  place_of_.reserve(static_cast<std::size_t>(keyframes_max));
  for (std::size_t i = 0; i < kPieces; ++i) {
    pieces_.push_back({.cells = MapPiece(resolution_m)});
  }
}

void WorldTiles::update(const SubmapWorld& world) {
  for_each_keyframe(world, [&](int keyframe, const Pose2& map_T_scan) {
    place_of_.resize(std::max(place_of_.size(), static_cast<std::size_t>(keyframe) + 1), kNowhere);
    int& place = place_of_[static_cast<std::size_t>(keyframe)];
    if (place == kNowhere) {
      place = static_cast<int>(placed_.size());
      placed_.push_back({keyframe, map_T_scan, world.store.farthest_m(keyframe)});
      note(static_cast<std::size_t>(place), false);
    } else {
      move(static_cast<std::size_t>(place), map_T_scan);
    }
  });
}

void WorldTiles::move(std::size_t place, const Pose2& map_T_scan) {
  constexpr double kLever_m = 10.0;
  PlacedKeyframe& placed = placed_[place];
  const double moved_m = placed.map_T_scan.distance_m(map_T_scan) +
                         kLever_m * std::abs(wrap_angle(placed.map_T_scan.yaw_rad - map_T_scan.yaw_rad));
  if (moved_m > resolution_m_) {
    note(place, true);
    placed.map_T_scan = map_T_scan;
    note(place, true);
  }
}

void WorldTiles::note(std::size_t place, bool is_stale) {
  for_each_piece(placed_[place], resolution_m_, [&](const PieceIndex& index) {
    known_[index].is_stale |= is_stale;
    waiting_.insert(index);
  });
}

WorldTiles::Piece& WorldTiles::piece_of(const PieceIndex& index) {
  auto found = std::find_if(pieces_.begin(), pieces_.end(),
                            [&index](const Piece& each) { return each.is_kept && each.cells.index() == index; });
  const bool is_new = found == pieces_.end();
  found = is_new ? std::prev(found) : found;
  pieces_.splice(pieces_.begin(), pieces_, found);
  Known& known = known_[index];
  if (is_new || known.is_stale) {
    found->cells.begin(index);
    found->drawn = 0;
    found->is_kept = true;
    known.is_stale = false;
    known.changed |= known.told;
  }
  return *found;
}

bool WorldTiles::work(const SubmapWorld& world) {
  constexpr int kKeyframes = 16;  // in a step
  if (waiting_.empty()) {
    return false;
  }
  const PieceIndex index = *waiting_.begin();
  Piece& piece = piece_of(index);
  for (int drawn = 0; drawn < kKeyframes && piece.drawn < placed_.size(); ++piece.drawn) {
    drawn += piece.cells.add(world.store, placed_[piece.drawn], model_, frame_) ? 1 : 0;
  }
  if (piece.drawn == placed_.size()) {
    waiting_.erase(index);
    known_[index].changed = kAllTiles;
  }
  return !waiting_.empty();
}

std::optional<WorldTiles::Index> WorldTiles::tell(Occupancy& out) {
  for (const Piece& piece : pieces_) {
    const PieceIndex& index = piece.cells.index();
    if (!piece.is_kept || waiting_.contains(index)) {
      continue;
    }
    Known& known = known_[index];
    while (known.changed != 0) {
      const int tile = std::countr_zero(known.changed);
      const std::uint32_t bit = std::uint32_t{1} << tile;
      known.changed &= ~bit;
      if (write(piece.cells, tile, out) || (known.told & bit) != 0) {
        known.told |= bit;
        return Index{index.column * kTilesPerSide + tile % kTilesPerSide,
                     index.row * kTilesPerSide + tile / kTilesPerSide};
      }
    }
  }
  return std::nullopt;
}

bool WorldTiles::write(const MapPiece& piece, int tile, Occupancy& out) const {
  const int left = tile % kTilesPerSide * kSide_cells;
  const int lowest = tile / kTilesPerSide * kSide_cells;
  bool is_known = false;
  auto next = out.begin();
  for (int row = lowest; row < lowest + kSide_cells; ++row) {
    for (int column = left; column < left + kSide_cells; ++column) {
      const Cell& cell = piece.cell(column, row);
      *next++ = cell.is_unknown() ? kUnknown : static_cast<std::uint8_t>(cell.occupancy_percent(rho_min_parts_));
      is_known |= !cell.is_unknown();
    }
  }
  return is_known;
}

}  // namespace odoless
