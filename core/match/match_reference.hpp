#pragma once

#include <span>

#include "core/match/matcher_params.hpp"
#include "core/match/orientation_histogram.hpp"
#include "core/ndt/ndt.hpp"
#include "core/ndt/score_raster.hpp"
#include "core/scan/point_set.hpp"
#include "core/scan/scan_frame.hpp"

namespace odoless {

/// A scan and where it was taken.
struct PlacedScan {
  const ScanFrame* scan = nullptr;
  Pose2 reference_T_scan{};
};

/// What a scan is matched against: one scan, or several whose poses are known (a local map).
///
/// Memory is fixed at construction. Thread: owned by one thread. Real time: `rebuild` does not allocate; its time is
/// linear in the points, the cells that they touch and the rasters' pixels.
class MatchReference {
 public:
  MatchReference(const ReferenceParams& params, int points_max);

  /// Replaces the reference by `scans`, newest first; the oldest are left out when they do not fit.
  /// Errc::kTooFewReturns leaves an empty one.
  [[nodiscard]] Errc rebuild(std::span<const PlacedScan> scans);

  [[nodiscard]] bool empty() const { return points_.size() == 0; }
  /// Of all points: what the last step climbs.
  [[nodiscard]] const Ndt& exact_ndt() const { return exact_ndt_; }
  /// Of the thinned points, free space marked: what the search ends on.
  [[nodiscard]] const ScoreRaster& fine() const { return fine_; }
  /// The same blurred, without free space: what the search begins on.
  [[nodiscard]] const ScoreRaster& coarse() const { return coarse_; }
  /// Painted from wide cells, on first use.
  [[nodiscard]] const ScoreRaster& wide();
  [[nodiscard]] const OrientationHistogram& orientations() const { return orientations_; }

 private:
  ReferenceParams params_;
  PointSet points_;
  PointSet thinned_;
  Ndt exact_ndt_;
  Ndt ndt_;
  Ndt wide_ndt_;
  ScoreRaster fine_;
  ScoreRaster coarse_;
  ScoreRaster wide_;
  bool wide_ready_ = false;
  OrientationHistogram orientations_;
};

}  // namespace odoless
