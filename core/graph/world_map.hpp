#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "core/graph/submap_matcher.hpp"
#include "core/grid/cell.hpp"
#include "core/grid/grid_cell.hpp"
#include "core/grid/grid_geometry.hpp"
#include "core/grid/occupancy_map.hpp"
#include "core/slam/beam_model.hpp"

namespace odoless {

/// The occupancy grid of a world, rendered from its keyframes at the poses that their submaps have now. As large as the
/// world is; memory for the tiles that a beam has crossed alone.
///
/// Frames: map. Thread: owned by one thread. Not for real-time threads: it allocates.
class WorldMap {
 public:
  /// @param beam          How beams make a map.
  /// @param resolution_m  A cell's side; of a world of more than 10^8 cells it is doubled until there are fewer.
  WorldMap(const BeamModelParams& beam, double resolution_m) : beam_(beam), resolution_m_(resolution_m) {}

  /// Adds every keyframe of the world. @param scan  Its ranges beyond `range_max_m` are no returns.
  void render(const SubmapWorld& world, const ScanParams& scan);
  /// What was rendered, cut to the known part; no cell where nothing is known.
  void write(OccupancyMap& map) const;

  /// For BeamModel::integrate.
  [[nodiscard]] Cell& at(const GridCell& cell);

 private:
  static constexpr int kTileBits = 6;
  static constexpr int kTileSide_cells = 1 << kTileBits;
  using Tile = std::vector<Cell>;

  void cover(const SubmapWorld& world);
  [[nodiscard]] const Tile* tile(int column, int row) const;

  BeamModelParams beam_;
  double resolution_m_;
  GridGeometry geometry_;
  int side_tiles_ = 0;
  std::vector<std::unique_ptr<Tile>> tiles_;
};

}  // namespace odoless
