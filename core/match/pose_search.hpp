#pragma once

#include <array>
#include <cstddef>
#include <span>

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

  [[nodiscard]] bool is_known() const { return sd_m > 0.0 && sd_rad > 0.0; }
  [[nodiscard]] double penalty(const SearchPoint& pose) const;
};

/// Where to search: what the reference scores, how its surfaces lie, and what is expected. And until when.
struct SearchGround {
  const ScoreRaster& coarse;
  const ScoreRaster& fine;
  const OrientationHistogram& reference_orientations;
  const MotionPrior& prior;
  const Ndt& exact_ndt;  ///< for `SearchParams::exact`
  Deadline deadline{};
};

/// What is searched for: a scan, in its own frame.
struct SearchedScan {
  PointSet points;  ///< thinned
  OrientationHistogram orientations;
};

/// Whether two poses are different answers rather than one answer and its noise.
[[nodiscard]] bool clearly_apart(const SearchPoint& a, const SearchPoint& b);

/// The best few answers, each clearly apart from the others, best first.
class Peaks {
 public:
  static constexpr std::size_t kMost = 4;

  /// Takes a pose in place of one that is the same but worse, while there is room, or in place of the worst.
  void offer(const ScoredPoint& pose);
  [[nodiscard]] std::size_t size() const { return size_; }
  /// At least one was offered.
  [[nodiscard]] const ScoredPoint& best() const { return peaks_[0]; }
  [[nodiscard]] std::span<const ScoredPoint> all() const { return {peaks_.data(), size_}; }
  /// Whether a pose is another answer than any of these.
  [[nodiscard]] bool is_apart(const SearchPoint& pose) const;

 private:
  std::array<ScoredPoint, kMost> peaks_{};
  std::size_t size_ = 0;
};

/// What a search found.
struct SearchOutcome {
  Peaks peaks;  ///< poses in the reference's frame, mean score per point; always the climb from the expected pose
  int evaluations = 0;
  StopReason stop = StopReason::kBudget;
};

/// Global search for the pose of a scan in a box around a guess: half of the starts as expected, with tails that reach
/// all of the box, half spread evenly with angles that the orientation histograms propose; Differential Evolution on a
/// blurred raster, then on the fine one, then a simplex on each peak.
///
/// Memory is fixed at construction. Thread: owned by one thread. Real time: no allocation; evaluations bounded by
/// `SearchParams`. A deadline is asked every 40 evaluations at the latest, but for those that an answer needs and that
/// are done after it too: the start points, the population on the fine raster, and one simplex from the best.
class PoseSearch {
 public:
  PoseSearch(const SearchParams& params, int points_max);

  /// For the searches from here on; `de` as at construction.
  void set_params(const SearchParams& params) { params_ = params; }

  [[nodiscard]] SearchOutcome run(const SearchGround& ground, const SearchedScan& scan, Rng& rng);

  /// Where the last search looked; its answer may have climbed out.
  [[nodiscard]] const SearchBox& box() const { return evolution_.box(); }

  /// Climbs from `start` to the peak of the fine raster near it with about `steps` evaluations, added to `evaluations`;
  /// at a deadline with fewer.
  [[nodiscard]] static ScoredPoint climb(const SearchGround& ground, const PointSet& points, const SearchPoint& start,
                                         int steps, int& evaluations);

 private:
  struct Objective;
  void start(const Objective& objective, const SearchGround& ground, const SearchedScan& scan);
  void cross_over_to(const Objective& fine, Rng& rng);
  void add_other_peaks(const Objective& fine, const Deadline& deadline, Peaks& peaks);

  SearchParams params_;
  PointSet subset_;
  AngleProposal angles_;
  DifferentialEvolution evolution_;
};

}  // namespace odoless
