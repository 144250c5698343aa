#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/deadline.hpp"
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
/// linear in the points, the cells that they touch and the rasters' pixels. A slice's is bounded: one scan, or
/// kSlice points or cells, or kSlice_px pixels.
class MatchReference {
 public:
  MatchReference(const ReferenceParams& params, int points_max);

  /// Replaces the reference by `scans`, newest first; the oldest are left out when they do not fit.
  /// Errc::kTooFewReturns leaves an empty one.
  [[nodiscard]] Errc rebuild(std::span<const PlacedScan> scans);
  /// The same in slices: `begin_rebuild`, then `rebuild_slice` until it says that all is done, while the scans stay as
  /// they are. In between nothing else may be asked.
  void begin_rebuild(std::span<const PlacedScan> scans);
  [[nodiscard]] bool rebuild_slice();
  /// Forgets the reference: it is empty until it is rebuilt.
  void clear() { points_.clear(); }

  [[nodiscard]] bool empty() const { return points_.size() == 0; }
  /// Of all points: what the last step climbs.
  [[nodiscard]] const Ndt& exact_ndt() const { return exact_ndt_; }
  /// Of the thinned points, free space marked: what the search ends on.
  [[nodiscard]] const ScoreRaster& fine() const { return fine_; }
  /// The same blurred, without free space: what the search begins on.
  [[nodiscard]] const ScoreRaster& coarse() const { return coarse_; }
  /// Painted from wide cells, on first use.
  [[nodiscard]] const ScoreRaster& wide();
  /// Paints `wide` until the deadline, and goes on with the next call. Returns whether it is there.
  [[nodiscard]] bool prepare_wide(const Deadline& deadline);
  [[nodiscard]] const OrientationHistogram& orientations() const { return orientations_; }

 private:
  enum class Stage : std::uint8_t { kScans, kExactNdt, kNdt, kCoarse, kFine, kFree, kDone };
  static constexpr int kSlice = 256;  ///< points or cells
  static constexpr int kSlice_px = 32768;

  /// Each returns whether its stage is done.
  [[nodiscard]] bool stage_slice();
  [[nodiscard]] bool add_scan();
  [[nodiscard]] bool mark_scan_free();
  void go_on();
  void begin_grids();

  ReferenceParams params_;
  PointSet points_;
  PointSet thinned_;
  Ndt exact_ndt_;
  Ndt ndt_;
  Ndt wide_ndt_;
  ScoreRaster fine_;
  ScoreRaster coarse_;
  ScoreRaster wide_;
  OrientationHistogram orientations_;
  std::span<const PlacedScan> scans_;  ///< of a rebuild
  Stage stage_ = Stage::kDone;
  std::size_t fitting_ = 0;  ///< scans that were added
  std::size_t free_ = 0;     ///< next of them to mark what it saw through
  bool wide_ndt_ready_ = false;
  bool wide_ready_ = false;
};

}  // namespace odoless
