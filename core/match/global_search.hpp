#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "core/base/parameters.hpp"
#include "core/grid/grid_cell.hpp"
#include "core/grid/grid_geometry.hpp"
#include "core/match/apart_poses.hpp"
#include "core/ndt/score_raster.hpp"
#include "core/scan/point_set.hpp"

namespace odoless {

/// A map to be searched, read square by square.
class MapSquares {
 public:
  static constexpr int kSide_cells = 16;
  using Square = std::array<std::uint8_t, std::size_t{kSide_cells} * kSide_cells>;

  virtual ~MapSquares() = default;
  [[nodiscard]] virtual GridGeometry geometry() const = 0;
  /// Occupancies in percent, 255 unknown, row by row; false, and nothing written, where nothing is known.
  [[nodiscard]] virtual bool read(GridCell corner, Square& percent) = 0;
};

struct GlobalSearchParams {
  RasterParams fine{.resolution_m = 0.1, .extent_m = 100.0, .sigma_min_m = 0.1};
  RasterParams coarse{.resolution_m = 0.2, .extent_m = 100.0, .sigma_min_m = 0.3};
  double free_penalty = 0.7;
  double step_m = 0.3;
  double step_rad = 0.0698;
  double thinning_m = 0.1;
  int coarse_points = 48;
  int peaks = 64;
  int candidates = 12;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.group("fine", self.fine, "Raster of the map on which candidates are refined; cut to the map.");
    visit.group("coarse", self.coarse, "Blurred raster of the map that is searched for candidates; cut to the map.");
    visit.value("free_penalty", self.free_penalty, Range{0.0, 1.0}, "Penalty for a point in a free cell of the map.");
    visit.value("step_m", self.step_m, Range{0.02, 5.0}, "Step of the search along x and y.");
    visit.value("step_rad", self.step_rad, Range{0.005, 1.6}, "Step of the search in yaw.");
    visit.value("thinning_m", self.thinning_m, Range{0.0, 1.0},
                "Distance between two points of the scan along a wall.");
    visit.value("coarse_points", self.coarse_points, Range{8, 10000}, "Largest number of points that the search uses.");
    visit.value("peaks", self.peaks, Range{2, 1000}, "Number of best distinct poses of the search that are refined.");
    visit.value("candidates", self.candidates, Range{2, 100},
                "Number of best refined poses that are followed as candidates.");
  }
};

/// Looks for a scan all over a map, whatever its size, in slices: (1) reads the map into two score rasters, as those of
/// MatchReference; (2) scores the scan on the blurred one at every place that is free and in every direction, in steps
/// that the blur bridges, and keeps the best peaks; (3) lets these climb on both rasters by a downhill simplex.
///
/// Every place and direction, and not a population that moves to the best: a twin of the best must be seen too.
///
/// Frames:    poses are map_T_scan. A map of more than 200 m is searched 100 m around the place given.
/// Thread:    owned by one thread.
/// Real time: no allocation after construction; `work` is bounded by its budget.
class GlobalSearch {
 public:
  GlobalSearch(const GlobalSearchParams& params, const GridGeometry& grid, int points_max);

  /// Forgets the map: it will be read anew.
  /// @param p_map_window  The centre of its grid.
  void forget_map(const Point2& last_p_map, const Point2& p_map_window = {});
  [[nodiscard]] bool has_map() const { return phase_ >= Phase::kIdle; }

  /// Looks for this scan from the beginning. Only when it has a map.
  void begin(const ScanFrame& scan);

  /// Goes on for so many evaluations of the coarse points, or what costs as much. The map must not change from the
  /// first slice until it is forgotten.
  /// @return  Evaluations spent: less where it is done, more by less than `step_evaluations_max`.
  int work(MapSquares& map, int evaluations);
  /// Most that one step of the work takes: a square of the map, a place, or a climb.
  [[nodiscard]] int step_evaluations_max() const;

  /// None was begun since it has the map.
  [[nodiscard]] bool is_idle() const { return phase_ == Phase::kIdle; }
  /// The search that was begun is at its end.
  [[nodiscard]] bool is_done() const { return phase_ == Phase::kDone; }
  /// What it found: candidates with their score on the fine raster, at most 1 per point.
  [[nodiscard]] std::span<const ScoredPoint> found() const { return found_.poses(); }

  /// The scan's points as the search thins them, to be climbed with.
  void load(const ScanFrame& scan, PointSet& points) const;
  /// Climbs the fine raster near `start`.
  [[nodiscard]] ScoredPoint climb(const PointSet& points, const SearchPoint& start, int steps) const;

 private:
  enum class Phase : std::uint8_t { kWalls, kFree, kIdle, kSweep, kClimb, kDone };

  [[nodiscard]] int read_square(MapSquares& map);
  void add(const MapSquares::Square& square, GridCell corner, const GridGeometry& grid);
  [[nodiscard]] int sweep_place();
  [[nodiscard]] int climb_peak();
  [[nodiscard]] double score(const ScoreRaster& raster, const PointSet& points, const SearchPoint& pose) const;

  GlobalSearchParams params_;
  Point2 half_map_m_;
  int directions_;
  ScoreRaster fine_;
  ScoreRaster coarse_;
  Point2 p_map_centre_{};  ///< of the rasters
  Point2 known_min_m_{};   ///< what is known, map frame
  Point2 known_max_m_{};
  MapSquares::Square square_{};
  PointSet points_;
  PointSet few_points_;
  ApartPoses peaks_;
  ApartPoses found_;
  Phase phase_ = Phase::kWalls;
  std::int64_t next_ = 0;
};

}  // namespace odoless
