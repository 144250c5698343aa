#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/parameters.hpp"
#include "core/geometry/pose2.hpp"
#include "core/scan/point_set.hpp"

namespace odoless {

struct NdtParams {
  double cell_size_m = 1.0;
  double extent_m = 32.0;
  int points_min = 3;
  double sigma_min_m = 0.02;
  double sigma_ratio_min = 0.0316;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.value("cell_size_m", self.cell_size_m, Range{0.1, 20.0},
                "Side of an NDT cell; 1 m indoors, 4 m for sparse scans.");
    visit.value("extent_m", self.extent_m, Range{1.0, 200.0},
                "Half the side of the square that the grids cover; farther points are ignored.");
    visit.value("points_min", self.points_min, Range{3, 100}, "Fewest points for a cell to have a distribution.");
    visit.value("sigma_min_m", self.sigma_min_m, Range{0.001, 1.0},
                "Smallest standard deviation of a cell's distribution: the noise of the sensor.");
    visit.value("sigma_ratio_min", self.sigma_ratio_min, Range{0.0, 1.0},
                "Smallest ratio of a cell's two standard deviations, so that a wall is thin but not a line.");
  }
};

/// Normal distribution of the points in one cell.
struct NdtCell {
  Point2 mean;  ///< in the reference's frame
  double cov_xx_m2 = 0.0;
  double cov_xy_m2 = 0.0;
  double cov_yy_m2 = 0.0;
  int points = 0;
};

/// Inverse of a cell's covariance after mending.
struct NdtInformation {
  double xx = 0.0;  ///< 1/m2
  double xy = 0.0;
  double yy = 0.0;
  double along = 0.0;  ///< the part that has no direction: of the longer axis
};

/// Mends a nearly singular covariance (the smaller deviation is at least `sigma_min_m` and `sigma_ratio_min` of the
/// larger one) and inverts it. [biber2003ndt, section III; method 2]
[[nodiscard]] NdtInformation mended_information(const NdtCell& cell, double sigma_min_m, double sigma_ratio_min);

/// Score of a pose with its derivatives over (x_m, y_m, yaw_rad).
struct NdtDerivatives {
  double score = 0.0;  ///< sum over the points, each in [0, 1]
  Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
  Eigen::Matrix3d hessian = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d gauss_newton = Eigen::Matrix3d::Zero();  ///< positive semi-definite part of -hessian
  /// What the walls hold: of `gauss_newton` the part across each cell's long axis. Along it there is the ripple of the
  /// cells' borders alone, which moves with the grid and not with the scene. A cell's axis is only as good as
  /// Ndt::kAxis_sd_rad, and what it may wrongly hold along the wall is taken off; so the sum may be slightly negative.
  Eigen::Matrix3d held = Eigen::Matrix3d::Zero();
};

/// Normal Distributions Transform of a point set: four grids, shifted by half a cell [biber2003ndt; method 2].
///
/// Memory is fixed at construction, but for a copy's, which grows as it is used. Thread: owned by one thread.
/// Real time: no allocation, but in a copy; `rebuild` is linear in the points and in the cells that they touch, also in
/// slices; `score` in the points.
class Ndt {
 public:
  static constexpr int kGrids = 4;
  static constexpr int kCells_max = 16384;      ///< of all four: 2 km of walls in cells of 0.5 m
  static constexpr double kAxis_sd_rad = 0.03;  ///< of a cell's long axis, see NdtDerivatives::held

  Ndt(const NdtParams& params, int points_max);

  /// Replaces the reference by `points`; what lies a cell or more beyond `extent_m` is ignored, and so is what would be
  /// in more than `kCells_max` cells.
  void rebuild(const PointSet& points);
  /// The same in slices: `begin_rebuild`, then `rebuild_slice` of the same points until it says that all is done. In
  /// between nothing else may be asked.
  void begin_rebuild();
  /// @param most  Points and cells in this slice.
  [[nodiscard]] bool rebuild_slice(const PointSet& points, int most);

  /// Sum over `points`, moved by `reference_T_points`, of exp(-d^T S^-1 d / 2), averaged over the four grids.
  [[nodiscard]] double score(const PointSet& points, const Pose2& reference_T_points) const;

  /// The same with gradient and Hessian.
  [[nodiscard]] NdtDerivatives derivatives(const PointSet& points, const Pose2& reference_T_points) const;

  /// One entry per cell with a distribution: what a raster paints.
  struct PlacedCell {
    NdtCell cell;
    Point2 corner;  ///< lower-left corner, reference frame
  };
  [[nodiscard]] std::span<const PlacedCell> cells() const { return cells_; }
  [[nodiscard]] const NdtParams& params() const { return params_; }

 private:
  struct Sums {
    Point2 corner{};  ///< what they are relative to, so that the squares stay small
    double x = 0.0, y = 0.0, xx = 0.0, xy = 0.0, yy = 0.0;
    int points = 0;
  };
  static constexpr std::int32_t kNone = -1;
  enum class Stage : std::uint8_t { kForget, kGather, kFinish, kDone };

  [[nodiscard]] int slot(int grid, double x_m, double y_m) const;
  [[nodiscard]] Point2 slot_corner(int slot_index) const;
  void forget(int slot_index);
  void gather(const Point2& p);
  void finish(int slot_index, const Sums& sum);

  NdtParams params_;
  double inverse_cell_size_ = 1.0;
  int side_cells_ = 0;
  std::size_t touched_max_ = 0;
  std::size_t cells_max_ = 0;
  Stage stage_ = Stage::kDone;           ///< of a rebuild
  std::size_t next_ = 0;                 ///< in this stage
  std::vector<Sums> sums_;               ///< per touched slot
  std::vector<std::int32_t> touched_;    ///< slots that hold points
  std::vector<std::int32_t> slot_sum_;   ///< slot -> index into sums_, or kNone
  std::vector<std::int32_t> slot_cell_;  ///< slot -> index into cells_, or kNone
  std::vector<PlacedCell> cells_;
  std::vector<NdtInformation> information_;
};

}  // namespace odoless
