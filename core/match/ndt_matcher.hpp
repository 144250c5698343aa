#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstdint>

#include "core/base/deadline.hpp"
#include "core/base/result.hpp"
#include "core/base/rng.hpp"
#include "core/match/match_reference.hpp"
#include "core/match/matcher_params.hpp"
#include "core/match/pose_search.hpp"
#include "core/match/refine.hpp"
#include "core/motion/robot_limits.hpp"

namespace odoless {

/// An answer that the scene allows.
struct MatchPeak {
  Pose2 reference_T_scan{};
  double score = 0.0;   ///< as MatchResult::score
  double weight = 0.0;  ///< probability that it is the right one of those found; all sum to 1
};

/// How a scan lies to its reference, and how far that can be trusted.
struct MatchResult {
  Pose2 reference_T_scan{};
  double fitness = 0.0;  ///< mean exact NDT score per return, 0 (no overlap) to 1 (every point on a mean)
  double score = 0.0;    ///< mean score per thinned point, less where points contradict free space
  bool converged = false;
  bool escalated = false;  ///< the first answer was poor or outside of its box, and the wider search was run
  StopReason stop = StopReason::kBudget;
  int evaluations = 0;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< over (x_m, y_m, yaw_rad), reference's axes
  Point2 weak_direction{1.0,
                        0.0};  ///< unit vector of the translation that the scene constrains least, reference's axes
  double strong_information_1_m2 = 0.0;  ///< curvature of the fitness across the weak direction
  double weak_information_1_m2 = 0.0;    ///< curvature of the fitness along it; near zero in a featureless corridor
  std::array<MatchPeak, Peaks::kMost> peaks{};  ///< distinct answers, the result first
  int peak_count = 0;

  /// Score of the second peak over the best one's; 0 where there is none, or one worse than no match at all.
  [[nodiscard]] double second_peak_ratio() const {
    return peak_count > 1 ? std::max(0.0, peaks[1].score) / std::max(1e-9, score) : 0.0;
  }
};

/// Where a scan is expected. The deviations say how far from there the motion may well lead; 0: anywhere in the box.
struct Expectation {
  Pose2 reference_T_scan{};
  double sd_m = 0.0;
  double sd_rad = 0.0;
  bool is_wide = false;  ///< it may well lead out of the box: the wide search is run as well
  Pose2 rest_T_scan{};   ///< where it would be at rest, reference frame: a start of the wide search
};

/// Of a pair of scans `period_s` apart about which nothing else is known: no motion, give or take what half of the
/// largest speeds lead to. A period of 0 or less, as in logs without stamps, allows all.
[[nodiscard]] Expectation expect_rest(const RobotLimits& limits, double period_s);

/// Matches a scan to a reference by a global search over the NDT score, with no prior but the centre of the box.
///
/// A poor match, one that climbed out of the box, and one that is expected anywhere are tried once more with wide
/// cells, a wider box and every rotation, and say so. Memory is fixed at construction. Thread: owned by one thread.
/// Real time: no allocation; bounded evaluations; at a deadline the best so far, after what PoseSearch and `refine` end
/// with.
class NdtMatcher {
 public:
  explicit NdtMatcher(const MatcherParams& params);

  /// Finds `reference_T_scan` in the box around `expected`. Errors: kNoReference, kTooFewReturns, kTooManyBeams.
  [[nodiscard]] Result<MatchResult> match(MatchReference& reference, const ScanFrame& scan, const Expectation& expected,
                                          const Deadline& deadline, Rng& rng);

 private:
  /// @param result  With `escalated` the wide search is run for sure; else it says whether it was.
  [[nodiscard]] SearchOutcome search(const SearchGround& ground, MatchReference& reference, Rng& rng,
                                     MatchResult& result);
  void probe(const SearchGround& ground, SearchOutcome& outcome, Point2 direction) const;
  void climb(const SearchGround& ground, const SearchOutcome& outcome, MatchResult& result) const;
  /// Of the answers, given the scan's points.
  void weigh(const Peaks& peaks, MatchResult& result) const;
  [[nodiscard]] bool is_poor(const SearchOutcome& outcome) const {
    return outcome.peaks.best().score < params_.score_min;
  }

  MatcherParams params_;
  SearchedScan scan_;
  PointSet returns_;
  PoseSearch search_;
  PoseSearch retry_;
};

}  // namespace odoless
