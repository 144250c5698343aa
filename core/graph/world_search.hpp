#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/graph/path_scan.hpp"
#include "core/graph/submap_world.hpp"
#include "core/scan/scan_frame.hpp"

namespace odoless {

/// A place where a piece of a path may lie.
struct FoundPlace {
  int submap = 0;
  Pose2 submap_T_piece{};
  double score = 0.0;  ///< mean per point: 1 where all lie on walls, less where some lie in free space
};

/// Looks for a piece of a path all over a world, knowing nothing of where it may be: each submap with its neighbours is
/// drawn into a small raster, and the piece's points are correlated with it in every direction, at every place that its
/// path passes [olson2009correlative; method 9]. In steps that the raster's blur bridges, so that nothing is missed.
///
/// Frames: piece, which is any frame near the path's own scans; a submap's own. Thread: owned by one thread. Memory is
/// fixed at construction. Not for real-time threads: a submap takes some 3 ms.
class WorldSearch {
 public:
  static constexpr double kReach_m = 20.0;  ///< from the piece's origin; farther points say nothing

  WorldSearch(const ScanParams& scan, int keyframe_beams_max);

  /// What is looked for from here on.
  void begin(const KeyframeStore& store, std::span<const PathScan> piece);
  /// Looks for it in one submap.
  void look(const SubmapWorld& world, int submap);
  /// The best places of those that were looked at, each apart from the others of its submap, best first.
  [[nodiscard]] std::span<const FoundPlace> found() const { return {found_.data(), count_}; }

 private:
  static constexpr double kCell_m = 0.25;
  static constexpr int kWindow_cells = 32;  ///< side of the square of places
  static constexpr int kSide_cells = 2 * 80 + kWindow_cells;
  static constexpr int kDirections = 120;
  static constexpr std::size_t kPoints_max = 400;
  static constexpr std::size_t kFound_max = 64;

  using Raster = std::vector<std::int8_t>;

  [[nodiscard]] static std::size_t index_of(int column, int row) {
    return static_cast<std::size_t>(row) * kSide_cells + static_cast<std::size_t>(column);
  }
  void draw(const SubmapWorld& world, int submap);
  void draw_scan(const Pose2& raster_T_scan);
  void blur();
  [[nodiscard]] std::int8_t* cell(const Point2& p);
  void correlate(double yaw_rad);
  void take_peaks(int submap, double yaw_rad);
  void offer(const FoundPlace& place);

  ScanFrame frame_;
  std::vector<Point2> points_;
  Raster raster_;  ///< of the submap
  Raster walls_;
  std::array<std::int16_t, std::size_t{kWindow_cells} * kWindow_cells> sums_{};
  std::array<FoundPlace, kFound_max> found_{};
  std::size_t count_ = 0;
};

}  // namespace odoless
