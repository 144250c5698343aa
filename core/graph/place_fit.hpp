#pragma once

#include <span>

#include "core/graph/map_piece.hpp"
#include "core/graph/path_scan.hpp"
#include "core/graph/submap_world.hpp"

namespace odoless {

/// How well a piece of a path fits where a match has it, by every beam of it: what a match of points alone does not
/// see, a beam that would go through a wall, speaks against the place.
///
/// Frames: piece; a submap's own. Thread: owned by one thread. Memory is fixed at construction. Not for real-time
/// threads: the place is drawn, which takes some 10 ms.
class PlaceFit {
 public:
  PlaceFit(const ScanParams& scan, int keyframe_beams_max);

  /// Share of the piece's returns that lie on walls of the submap and its neighbours, of those where they know
  /// anything.
  [[nodiscard]] double explained(const SubmapWorld& world, int submap, std::span<const PathScan> piece,
                                 const Pose2& submap_T_piece);

 private:
  struct Tally {
    int explained = 0;
    int contradicted = 0;
  };

  void draw(const SubmapWorld& world, int submap, const Pose2& submap_T_piece);
  void count(const Pose2& map_T_scan, Tally& tally) const;
  [[nodiscard]] const Cell* cell(const Point2& p) const;
  [[nodiscard]] bool is_near_wall(const Point2& p) const;

  ScanFrame frame_;
  BeamModel beams_;
  MapPiece map_;
};

}  // namespace odoless
