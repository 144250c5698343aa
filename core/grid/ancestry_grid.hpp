#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/parameters.hpp"
#include "core/grid/ancestry_tree.hpp"
#include "core/grid/cell.hpp"
#include "core/grid/grid_cell.hpp"
#include "core/grid/grid_geometry.hpp"
#include "core/grid/occupancy_map.hpp"

namespace odoless {

struct AncestryGridParams {
  double resolution_m = 0.05;
  double width_m = 100.0;
  double height_m = 100.0;
  int tiles_max = 32768;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.value("resolution_m", self.resolution_m, Range{0.005, 1.0}, "Side of a map cell.");
    visit.value("width_m", self.width_m, Range{1.0, 2000.0},
                "Extent along x of the filter's window of map, which follows the robot; rounded up to whole tiles.");
    visit.value("height_m", self.height_m, Range{1.0, 2000.0}, "Extent along y of the filter's window of map.");
    visit.value("tiles_max", self.tiles_max, Range{16, 4'000'000},
                "Most tiles of 16 x 16 cells, shared by the maps of all particles; 1 KiB each.");
  }
};

/// The maps of all particles in one grid, without copies of what they share [eliazar2003dpslam; method 6].
///
/// The grid is cut into tiles of 16 x 16 cells. A tile holds one version for each node of the particles' ancestry that
/// observed something in it; a version is cumulative: it begins as a copy of the nearest ancestor's and goes on from
/// there, so a particle sees a tile as its nearest ancestor left it. DP-SLAM keeps such versions per cell; per tile
/// the maps are the same, with one look-up for all cells that a beam crosses in a tile and no list entry per cell.
///
/// The grid is a window into a plane without edges: it can be moved, and what it leaves behind is forgotten. A tile
/// keeps its place in memory while the window moves (column and row modulo those of the window).
///
/// To answer "which version does this particle see" at once, the first look at a tile after the family changed writes
/// the answer down for all leaves; this costs time in the order of the particles per tile, whatever the lineage's
/// length.
///
/// Promises:  a map is the same, bit for bit, as one of its own would be (plain_particles in the tests), as long as the
///            pool lasts. When it is full, observations in tiles that have no version of the particle's own are refused
///            and counted, for as long as it is full.
/// Thread:    owned by one thread.
/// Real time: no allocation after construction, but in a copy, which grows as it is used.
class AncestryGrid {
 public:
  static constexpr int kTileBits = 4;
  static constexpr int kTileSide_cells = 1 << kTileBits;

  /// Tiles that observations were refused in or that lie outside of the grid, each counted once per beam and entry.
  struct Counters {
    std::int64_t refused_tiles = 0;
    std::int64_t outside_tiles = 0;
  };

  AncestryGrid(const AncestryGridParams& params, int particles_max);

  /// One particle, nothing observed.
  void reset();
  /// Moves the window towards having this cell in its middle half, by at most one row and column of tiles, and forgets
  /// the tiles that it leaves. Linear in their versions: at most one per particle and ancestor.
  void follow(const GridCell& cell);
  /// Puts the window's centre next to this cell at once. Only when nothing is observed, as after `reset`.
  void centre_on(const GridCell& cell);

  /// The robot's travel, by which tiles grow old.
  void set_travel(double travel_m) { travel_m_ = travel_m; }
  /// Looks at so many tiles, in turn, and forgets those that nothing was added to since that travel.
  void forget_before(double travel_m, int tiles);

  /// The two halves of a resampling: see AncestryTree.
  void retain(std::span<const int> copies);
  void branch(std::span<const int> copies);

  class View;
  class Writer;
  /// A particle's map to read; valid until the next `retain`, `branch` or use of a `Writer` of the same particle.
  [[nodiscard]] View view(int particle);
  /// A particle's map to add observations to; only one at a time.
  [[nodiscard]] Writer writer(int particle);

  /// The particle's map as occupancies: the probability, in percent, that a beam which crosses the cell along an axis
  /// stops in it. Cut to the tiles that the particle knows. May allocate, in `map` alone.
  void write_occupancy(int particle, double rho_min_m, OccupancyMap& map);

  /// A square of the particle's map, row by row from the lowest: percent as in `write_occupancy`, 255 unknown. False,
  /// and nothing written, where the particle knows nothing. Real time: no allocation; linear in the cells.
  ///
  /// @param corner      The square's lower-left cell; the square may reach out of the grid.
  /// @param percent     side_cells * side_cells.
  [[nodiscard]] bool write_square(int particle, double rho_min_m, GridCell corner, int side_cells,
                                  std::span<std::uint8_t> percent);

  [[nodiscard]] const GridGeometry& geometry() const { return geometry_; }
  [[nodiscard]] const AncestryTree& tree() const { return tree_; }
  [[nodiscard]] const Counters& counters() const { return counters_; }
  [[nodiscard]] int tiles_used() const { return static_cast<int>(versions_.size() - kFirstVersion - free_.size()); }

 private:
  using Node = AncestryTree::Node;
  using Version = std::uint32_t;
  static constexpr Version kBlank = 0;  ///< what nobody has observed; never written
  static constexpr Version kWaste = 1;  ///< takes what is refused; never read
  static constexpr std::uint32_t kFirstVersion = 2;
  static constexpr Version kNone = 0;
  static constexpr std::uint32_t kOutside = UINT32_MAX;
  static constexpr std::uint64_t kNoTile = UINT64_MAX;  ///< GridCell::tile of no cell

  struct alignas(64) Tile {
    std::array<Cell, std::size_t{kTileSide_cells} * kTileSide_cells> cells;
  };

  /// Nodes own versions through a number that two nodes can swap, so that a merge moves the shorter list.
  using Owner = std::uint32_t;

  /// Whose version of which tile, in two lists: versions of the tile (descendants before ancestors), tiles of the
  /// owner.
  struct Entry {
    Owner owner = 0;
    std::uint32_t tile = 0;
    Version next_in_tile = kNone;
    Version previous_in_tile = kNone;
    Version next_of_owner = kNone;
    Version previous_of_owner = kNone;
  };

  struct OwnedTiles {
    Version first = kNone;
    std::uint32_t count = 0;
  };

  [[nodiscard]] std::uint32_t tile_of(const GridCell& cell) const;
  /// The lower-left cell of a tile.
  [[nodiscard]] GridCell corner_of(std::uint32_t tile) const;
  void step_columns(int direction);
  void step_rows(int direction);
  void forget(std::uint32_t tile);
  /// The version of a tile that the leaf with this rank sees.
  [[nodiscard]] Version& seen(std::uint32_t tile, std::uint32_t rank) {
    if (answers_of_tile_[tile] == 0) {
      answer(tile);
    }
    return answers_[static_cast<std::size_t>(answers_of_tile_[tile] - 1) * leaves_max_ + rank];
  }
  void answer(std::uint32_t tile);
  void forget_answers();
  [[nodiscard]] Version own_version(std::uint32_t tile, Node leaf, std::uint32_t rank);
  [[nodiscard]] Version unused_version();
  void link_to_tile(Version version, std::uint32_t tile);
  void unlink_from_tile(Version version);
  void link_to_owner(Version version, Owner owner);
  void unlink_from_owner(Version version);
  void remove(Version version);
  void merge(Node gone, Node heir);
  void move_versions(Owner from, Owner to, bool from_is_newer);
  [[nodiscard]] Version find_beside(Version version, Owner owner, bool below) const;

  std::uint32_t tile_columns_;
  std::uint32_t tile_rows_;
  GridGeometry geometry_;
  AncestryTree tree_;
  std::size_t leaves_max_;
  std::size_t versions_max_;
  std::vector<Tile> tiles_;      ///< by version; those never used yet are not in it, and not touched
  std::vector<Entry> versions_;  ///< by version
  std::vector<Version> free_;    ///< of those in it
  std::vector<Version> first_of_tile_;
  std::vector<OwnedTiles> owned_;               ///< by owner
  std::vector<Owner> owner_of_node_;            ///< a permutation,
  std::vector<Node> node_of_owner_;             ///< and its inverse
  std::vector<std::uint32_t> answers_of_tile_;  ///< 0: none yet, else 1 + its row in answers_
  std::vector<std::uint32_t> answered_;         ///< tiles that have answers
  std::vector<Version> answers_;                ///< rows of versions, by rank of the leaf; as many as were ever needed
  std::vector<float> written_m_;                ///< by tile: travel at the last observation
  double travel_m_ = 0.0;
  std::uint32_t next_to_forget_ = 0;
  Counters counters_;
};

/// Reads one particle's map cell by cell; neighbours in a row are cheap.
class AncestryGrid::View {
 public:
  /// Any cell; outside of the grid is unknown.
  [[nodiscard]] const Cell& at(const GridCell& cell) {
    if (cell.tile<kTileBits>() != tile_) {
      enter(cell);
    }
    return cells_[cell.index_in_tile<kTileBits>()];
  }

 private:
  friend class AncestryGrid;
  View(AncestryGrid& grid, int particle) : grid_(grid), rank_(grid.tree_.rank(particle)) {}

  void enter(const GridCell& cell);

  AncestryGrid& grid_;
  std::uint32_t rank_;
  std::uint64_t tile_ = kNoTile;
  const Cell* cells_ = nullptr;
};

/// Adds observations to one particle's map.
class AncestryGrid::Writer {
 public:
  /// The cell to add to. Outside of the grid, or where the pool refuses, a cell that nobody reads.
  [[nodiscard]] Cell& at(const GridCell& cell) {
    if (cell.tile<kTileBits>() != tile_) {
      enter(cell);
    }
    return cells_[cell.index_in_tile<kTileBits>()];
  }

 private:
  friend class AncestryGrid;
  Writer(AncestryGrid& grid, int particle)
      : grid_(grid), leaf_(grid.tree_.leaf(particle)), rank_(grid.tree_.rank(particle)) {}

  void enter(const GridCell& cell);

  AncestryGrid& grid_;
  Node leaf_;
  std::uint32_t rank_;
  std::uint64_t tile_ = kNoTile;
  Cell* cells_ = nullptr;
};

inline AncestryGrid::View AncestryGrid::view(int particle) { return {*this, particle}; }
inline AncestryGrid::Writer AncestryGrid::writer(int particle) { return {*this, particle}; }

}  // namespace odoless
