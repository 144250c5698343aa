#pragma once

#include <optional>

#include "core/base/deadline.hpp"
#include "core/base/rng.hpp"
#include "core/match/matcher_params.hpp"
#include "core/match/orientation_histogram.hpp"
#include "core/ndt/score_raster.hpp"
#include "core/optimize/differential_evolution.hpp"
#include "core/optimize/nelder_mead.hpp"
#include "core/scan/point_set.hpp"

namespace odoless {

/// Where to search: what the reference scores, and how its surfaces lie.
struct SearchGround {
  const ScoreRaster& coarse;
  const ScoreRaster& fine;
  const OrientationHistogram& reference_orientations;
};

/// What is searched for: a scan, in its own frame.
struct SearchedScan {
  PointSet points;  ///< thinned
  OrientationHistogram orientations;
};

/// What a search found.
struct SearchOutcome {
  ScoredPoint best;                   ///< pose in the reference's frame, mean score per point
  std::optional<ScoredPoint> second;  ///< another peak, clearly apart
  int evaluations = 0;
  StopReason stop = StopReason::kBudget;
};

/// Global search for the pose of a scan in a box around a guess: even starts with angles that the orientation
/// histograms propose, Differential Evolution on a blurred raster, then on the fine one, then a simplex.
///
/// Memory is fixed at construction. Thread: owned by one thread. Real time: no allocation; evaluations bounded by
/// `SearchParams`; at a deadline the best so far.
class PoseSearch {
 public:
  PoseSearch(const SearchParams& params, int points_max);

  [[nodiscard]] SearchOutcome run(const SearchGround& ground, const SearchedScan& scan, const Pose2& guess,
                                  const Deadline& deadline, Rng& rng);

  /// Climbs from `start` to the peak of `raster` near it with at most `steps` evaluations (counted in `evaluations`).
  [[nodiscard]] static ScoredPoint climb(const ScoreRaster& raster, const PointSet& points, const SearchPoint& start,
                                         int steps, int& evaluations);

 private:
  struct Objective;
  void start(const Objective& coarse, const SearchGround& ground, const SearchedScan& scan);
  void cross_over_to(const Objective& fine, Rng& rng);
  [[nodiscard]] std::optional<ScoredPoint> second_peak(const Objective& fine, const ScoredPoint& best);

  SearchParams params_;
  SearchBox box_;
  PointSet subset_;
  AngleProposal angles_;
  DifferentialEvolution evolution_;
};

/// Whether two poses are different answers rather than one answer and its noise.
[[nodiscard]] bool clearly_apart(const SearchPoint& a, const SearchPoint& b);

}  // namespace odoless
