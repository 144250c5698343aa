#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/geometry/pose2.hpp"
#include "core/graph/keyframe_store.hpp"
#include "core/grid/cell.hpp"
#include "core/grid/grid_cell.hpp"
#include "core/slam/beam_model.hpp"

namespace odoless {

/// Which piece of the plane: its lower-left corner is at (column, row) pieces' sides from the map frame's origin.
struct PieceIndex {
  std::int32_t row = 0;
  std::int32_t column = 0;
  // NOLINTNEXTLINE(modernize-use-nullptr): it takes the 0 that this is compared with for a pointer
  friend auto operator<=>(const PieceIndex&, const PieceIndex&) = default;
};

/// A keyframe where the world has it.
struct PlacedKeyframe {
  int keyframe = 0;
  Pose2 map_T_scan{};
  double farthest_m = 0.0;  ///< KeyframeStore::farthest_m
};

/// A square piece of the plane as an occupancy grid, which takes of each beam what crosses it: so that a map of any
/// extent can be drawn piece by piece.
///
/// Frames: map. Thread: owned by one thread. Memory: 1 MB, at construction.
class MapPiece {
 public:
  static constexpr int kBits = 9;
  static constexpr int kSide_cells = 1 << kBits;

  explicit MapPiece(double resolution_m)
      : resolution_m_(resolution_m), cells_(std::size_t{kSide_cells} * kSide_cells) {}

  /// Of nothing known.
  void begin(const PieceIndex& index);
  [[nodiscard]] const PieceIndex& index() const { return index_; }
  [[nodiscard]] const Cell& cell(int column, int row) const {
    return cells_[GridCell(column, row).index_in_tile<kBits>()];
  }

  /// Adds what crosses the piece of a keyframe's beams. @param frame  Scratch.
  /// @return  Whether anything may.
  bool add(const KeyframeStore& store, const PlacedKeyframe& placed, const BeamModel& model, ScanFrame& frame);

  /// For BeamModel::integrate, in the piece's own cells. What is outside goes nowhere.
  [[nodiscard]] Cell& at(const GridCell& cell);

 private:
  void add(const BeamModel& model, const Point2& start, const Point2& direction, double length_cells);

  double resolution_m_;
  PieceIndex index_;
  std::vector<Cell> cells_;
  Cell outside_;
};

/// Which pieces a keyframe's beams may cross.
template <class Take>
void for_each_piece(const PlacedKeyframe& placed, double resolution_m, const Take& take) {
  const auto piece_at = [resolution_m](double x_m) {
    return static_cast<std::int32_t>(std::floor(x_m / (resolution_m * MapPiece::kSide_cells)));
  };
  const Pose2& pose = placed.map_T_scan;
  const double reach_m = placed.farthest_m;
  for (std::int32_t row = piece_at(pose.y_m - reach_m); row <= piece_at(pose.y_m + reach_m); ++row) {
    for (std::int32_t column = piece_at(pose.x_m - reach_m); column <= piece_at(pose.x_m + reach_m); ++column) {
      take(PieceIndex{row, column});
    }
  }
}

}  // namespace odoless
