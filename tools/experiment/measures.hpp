#pragma once

#include <span>
#include <string>
#include <vector>

#include "tools/eval/pairs.hpp"
#include "tools/log/reference_poses.hpp"
#include "tools/output/matches.hpp"

namespace odoless {

/// How a match differs from the true displacement, in the dissertation's axes: delta y is along the heading, delta x
/// across it, to the right.
struct DisplacementError {
  int index = 0;  ///< of the later scan
  double x_m = 0.0;
  double y_m = 0.0;
  double yaw_rad = 0.0;
  Pose2 true_motion{};  ///< in the product's axes

  [[nodiscard]] double translation_m() const;
};

/// `poses` has one pose per scan of the log, as a simulation's truth does.
[[nodiscard]] std::vector<DisplacementError> displacement_errors(std::span<const MatchRow> matches,
                                                                 std::span<const ReferencePose> poses);

/// The matches one after the other, from `start`: one pose more than there are matches.
[[nodiscard]] std::vector<Pose2> chain(std::span<const MatchRow> matches, const Pose2& start);

/// A trajectory, whose map begins anywhere, in the world's frame: both begin in the same pose.
[[nodiscard]] std::vector<Pose2> placed(std::span<const ReferencePose> trajectory, const Pose2& world_T_start);

/// Distance of each pose from the true one of the same index.
[[nodiscard]] std::vector<double> position_errors_m(std::span<const Pose2> poses, std::span<const ReferencePose> truth);

/// What the errors of a set of matches look like.
struct MatchingSummary {
  std::string label{};
  std::size_t pairs = 0;
  std::size_t gross = 0;  ///< off by more than 0.2 m or 5 deg
  double median_m = 0.0;
  double median_rad = 0.0;
  double rms_m = 0.0;
  double max_m = 0.0;
  double time_median_us = 0.0;  ///< CPU time of a match
};

[[nodiscard]] MatchingSummary summarise_matching(const std::string& label, const ReferencePoses& truth,
                                                 std::span<const MatchRow> matches);

/// A normal distribution that is fitted to the middle of a set, so that a few outliers don't widen it.
struct RobustNormal {
  double mean = 0.0;       ///< the median
  double deviation = 0.0;  ///< 1.4826 times the median of what they are off by
};

[[nodiscard]] RobustNormal fit_normal(const std::vector<double>& values);

/// The value that a share of them does not exceed.
[[nodiscard]] double quantile(std::vector<double> values, double share);

}  // namespace odoless
