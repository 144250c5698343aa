#pragma once

#include <array>
#include <cstddef>

#include "core/geometry/pose2.hpp"
#include "core/scan/scan_frame.hpp"

namespace odoless {

/// Histogram of the directions of the surfaces that a scan saw, by length. Two scans of one place have the same
/// histogram but for a shift by the angle between them, wherever they were taken [weiss1994orientation; method 3].
class OrientationHistogram {
 public:
  static constexpr std::size_t kBins = 180;  ///< over a full turn
  static constexpr double kBin_rad = 2.0 * std::numbers::pi / kBins;

  void clear() { bins_.fill(0.0F); }
  /// Adds the surfaces of `scan`, turned by `yaw_rad`: steps of about `spacing_m` between returns that are neighbours.
  void add(const ScanFrame& scan, double yaw_rad, double spacing_m);
  /// Blurs by a bin to either side.
  void smooth();
  /// Sum of products with `other` turned by `shift` bins.
  [[nodiscard]] double correlation(const OrientationHistogram& other, int shift) const;

 private:
  std::array<float, kBins> bins_{};
};

/// Draws angles in proportion to how well two histograms fit when one is turned by that angle.
class AngleProposal {
 public:
  /// Angles in centre_rad +- half_range_rad; a share of `floor_share` is spread evenly over them.
  void rebuild(const OrientationHistogram& reference, const OrientationHistogram& scan, double centre_rad,
               double half_range_rad, double floor_share);
  /// Offset from the centre for a fraction in [0, 1] of the probability.
  [[nodiscard]] double offset_rad(double fraction) const;

 private:
  std::array<double, OrientationHistogram::kBins + 1> cumulative_{};
  double first_rad_ = 0.0;
  double step_rad_ = 0.0;
  int steps_ = 0;
};

}  // namespace odoless
