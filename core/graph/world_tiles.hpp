#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <list>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <vector>

#include "core/graph/map_piece.hpp"
#include "core/graph/submap_world.hpp"
#include "core/slam/beam_model.hpp"

namespace odoless {

/// The map of a world that grows and is corrected, as square tiles that are told when they have changed: a keyframe is
/// drawn once where it is new, and all that crosses a piece of the plane anew where a correction has moved a submap by
/// more than a cell.
///
/// Frames: map. Thread: owned by one thread. Not for real-time threads. Memory: 1 MB for each of kPieces that are kept
/// to be drawn on; the others are drawn from the keyframes when they change.
class WorldTiles {
 public:
  static constexpr int kSide_cells = 128;
  static constexpr std::size_t kPieces = 16;
  /// In percent, row by row from the lowest; 255: unknown.
  using Occupancy = std::array<std::uint8_t, std::size_t{kSide_cells} * kSide_cells>;
  /// A tile's lower-left corner is at (column, row) * kSide_cells cells from the map frame's origin.
  struct Index {
    int column = 0;
    int row = 0;
  };

  WorldTiles(const BeamModelParams& beam, const ScanParams& scan, double resolution_m, int keyframes_max);

  /// Notes what is new in the world and what has moved. Linear in the keyframes that have.
  void update(const SubmapWorld& world);
  /// One step of the drawing, of at most a few milliseconds. @return  Whether there is more.
  bool work(const SubmapWorld& world);
  /// A tile that has changed since it was told last, written to `out`; none: all are told.
  [[nodiscard]] std::optional<Index> tell(Occupancy& out);

 private:
  static constexpr int kTilesPerSide = MapPiece::kSide_cells / kSide_cells;

  struct Piece {
    MapPiece cells;
    std::size_t drawn = 0;  ///< keyframes from the first one on
    bool is_kept = false;   ///< it is of the plane
  };
  struct Known {
    bool is_stale = false;      ///< what was drawn has moved
    std::uint32_t changed = 0;  ///< tiles: a bit each
    std::uint32_t told = 0;
  };

  void move(std::size_t place, const Pose2& map_T_scan);
  void note(std::size_t place, bool is_stale);
  /// The piece that is drawn on: kept, or the one that was not used for longest.
  Piece& piece_of(const PieceIndex& index);
  void finish(const PieceIndex& index);
  bool write(const MapPiece& piece, int tile, Occupancy& out) const;

  ScanFrame frame_;
  BeamModel model_;
  double resolution_m_;
  float rho_min_parts_;
  std::vector<PlacedKeyframe> placed_;  ///< as they are drawn, in the order in which they came into the world
  std::vector<int> place_of_;           ///< each keyframe's place there
  std::vector<Pose2> submaps_;          ///< as they are drawn
  Pose2 map_T_odom_{};                  ///< the same of keyframes without a submap
  std::list<Piece> pieces_;             ///< the one that was used last first
  std::map<PieceIndex, Known> known_;
  std::set<PieceIndex> waiting_;  ///< to be drawn
};

}  // namespace odoless
