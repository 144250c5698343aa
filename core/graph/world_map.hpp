#pragma once

#include <set>

#include "core/graph/map_piece.hpp"
#include "core/graph/submap_matcher.hpp"
#include "core/grid/occupancy_map.hpp"
#include "core/slam/beam_model.hpp"

namespace odoless {

/// The occupancy grid of a world, rendered from its keyframes at the poses that their submaps have now: piece by piece,
/// each from all beams that cross it, so that a world of any size takes the memory of one piece and of the result.
///
/// Frames: map. Thread: owned by one thread. Not for real-time threads: it allocates.
class WorldMap {
 public:
  /// @param beam          How beams make a map.
  /// @param resolution_m  A cell's side; of a world of more than 10^8 cells it is doubled until there are fewer.
  WorldMap(const BeamModelParams& beam, double resolution_m) : beam_(beam), resolution_m_(resolution_m) {}

  /// Every keyframe of the world. @param scan  Its ranges beyond `range_max_m` are no returns.
  void render(const SubmapWorld& world, const ScanParams& scan);
  /// What was rendered, cut to the known part; no cell where nothing is known.
  void write(OccupancyMap& map) const { map = map_; }

 private:
  /// Makes room for all pieces.
  void cover(const std::set<PieceIndex>& pieces);
  void take(const MapPiece& piece);
  /// Leaves away rows and columns of which nothing is known.
  void cut();

  BeamModelParams beam_;
  double resolution_m_;
  int first_column_ = 0;  ///< of the map, in cells from the map frame's origin
  int first_row_ = 0;
  OccupancyMap map_;
};

}  // namespace odoless
