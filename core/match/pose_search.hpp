#pragma once

#include <optional>

#include "core/base/deadline.hpp"
#include "core/base/rng.hpp"
#include "core/match/matcher_params.hpp"
#include "core/match/orientation_histogram.hpp"
#include "core/ndt/ndt.hpp"
#include "core/ndt/score_raster.hpp"
#include "core/optimize/differential_evolution.hpp"
#include "core/optimize/nelder_mead.hpp"
#include "core/scan/point_set.hpp"

namespace odoless {

/// Where the scan is expected, and how firmly. The box is centred there. Within one deviation every pose is as good;
/// beyond, a pose must score more to win: `weight` times the logarithm of its squared deviations, as a heavy-tailed law
/// has it.
struct MotionPrior {
  Pose2 reference_T_scan{};
  double sd_m = 0.0;  ///< 0: no expectation within the box
  double sd_rad = 0.0;
  double weight = 0.0;

  [[nodiscard]] double penalty(const SearchPoint& pose) const;
};

/// Where to search: what the reference scores, how its surfaces lie, and what is expected.
struct SearchGround {
  const ScoreRaster& coarse;
  const ScoreRaster& fine;
  const OrientationHistogram& reference_orientations;
  const MotionPrior& prior;
  const Ndt& exact_ndt;  ///< for `SearchParams::exact`
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

  [[nodiscard]] SearchOutcome run(const SearchGround& ground, const SearchedScan& scan, const Deadline& deadline,
                                  Rng& rng);

  /// Where the last search looked; its answer may have climbed out.
  [[nodiscard]] const SearchBox& box() const { return evolution_.box(); }

  /// Climbs from `start` to the peak of the fine raster near it with about `steps` evaluations, added to `evaluations`.
  [[nodiscard]] static ScoredPoint climb(const SearchGround& ground, const PointSet& points, const SearchPoint& start,
                                         int steps, int& evaluations);

 private:
  struct Objective;
  void start(const Objective& objective, const SearchGround& ground, const SearchedScan& scan);
  void cross_over_to(const Objective& fine, Rng& rng);
  [[nodiscard]] std::optional<ScoredPoint> second_peak(const Objective& fine, const ScoredPoint& best);

  SearchParams params_;
  PointSet subset_;
  AngleProposal angles_;
  DifferentialEvolution evolution_;
};

/// Whether two poses are different answers rather than one answer and its noise.
[[nodiscard]] bool clearly_apart(const SearchPoint& a, const SearchPoint& b);

}  // namespace odoless
