#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/parameters.hpp"
#include "core/geometry/pose2.hpp"
#include "core/ndt/ndt.hpp"
#include "core/scan/scan_frame.hpp"

namespace odoless {

struct RasterParams {
  double resolution_m = 0.05;
  double extent_m = 20.0;
  double sigma_min_m = 0.05;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.value("resolution_m", self.resolution_m, Range{0.01, 1.0}, "Side of a pixel.");
    visit.value("extent_m", self.extent_m, Range{1.0, 100.0},
                "Half the side of the raster; points beyond score nothing.");
    visit.value("sigma_min_m", self.sigma_min_m, Range{0.005, 2.0},
                "Smallest standard deviation in the raster; a larger one blurs it and makes the search easier.");
  }
};

/// An NDT painted into pixels of 16 bits, so that a pose is scored with one look-up per point instead of four Gaussians
/// [bench_core: BM_NdtScore]. Pixels that the reference saw through may be marked as free: they score below zero.
///
/// Memory is fixed at construction. Thread: owned by one thread. Real time: no allocation.
class ScoreRaster {
 public:
  static constexpr double kUnit = 16384.0;  ///< a perfect point's value

  explicit ScoreRaster(const RasterParams& params);

  /// Repaints all from `ndt`.
  void paint(const Ndt& ndt);
  /// The same in slices: `begin_paint`, then `paint_slice` of the same until it says that all is done.
  void begin_paint() { painted_ = 0; }
  /// @param pixels  To paint in this slice, and as many more as its last cell has.
  [[nodiscard]] bool paint_slice(const Ndt& ndt, int pixels);

  /// Marks what the beams of `scan` went through, up to `margin_m` before the nearest of three neighbours: such a pixel
  /// scores n - penalty * max(0, 1 - 4 n), n being its NDT score. Beams without return say nothing, nor those that see
  /// less than a pixel; of a scan with more than a turn, the first turn counts.
  void mark_free(const ScanFrame& scan, const Pose2& reference_T_scan, double margin_m, double penalty);

  /// Empties it, to be filled from a map: every `stamp` before the first `mark_free`.
  void clear();
  /// A point of a wall: the pixels near it score at least exp(-d^2 / 2 sigma^2) at the distance d from it, sigma being
  /// `sigma_min_m`.
  void stamp(const Point2& p_reference);
  /// The pixel at a point is free: it scores as `mark_free` of a scan has it.
  void mark_free(const Point2& p_reference, double penalty);
  /// Whether the pixel at a point was marked as free.
  [[nodiscard]] bool is_free(const Point2& p_reference) const;

  /// Sum over the points (x_m[i], y_m[i]), moved by `reference_T_points`, in units of a perfect point.
  /// The spans have one size.
  [[nodiscard]] double score(std::span<const float> x_m, std::span<const float> y_m,
                             const Pose2& reference_T_points) const;

  /// Value at a point, for tests.
  [[nodiscard]] double at(const Point2& p_reference) const;

  [[nodiscard]] const RasterParams& params() const { return params_; }

 private:
  /// A part of a disc within the half plane y >= 0, as seen from its apex.
  struct HalfWedge {
    double start_rad;
    double end_rad;
    double radius_m;
  };

  /// Of a point, in pixels from the lower-left corner.
  [[nodiscard]] Point2 in_pixels(const Point2& p_reference) const {
    return {p_reference.x_m * inverse_resolution_ + 0.5 * side_px_,
            p_reference.y_m * inverse_resolution_ + 0.5 * side_px_};
  }
  /// Returns the number of its pixels.
  int paint_cell(const Ndt::PlacedCell& placed, double side_m, double sigma_ratio_min);
  void mark_wedge(double start_rad, double end_rad, double radius_m, const Point2& apex, double penalty);
  void mark_half_wedge(const HalfWedge& wedge, const Point2& apex, double mirror, double penalty);
  void mark_span(int row, double from_px, double to_px, double penalty);

  RasterParams params_;
  int side_px_;
  double inverse_resolution_;
  int painted_ = 0;  ///< of the rows, which are emptied, and then the cells
  std::vector<std::int16_t> pixels_;
};

}  // namespace odoless
