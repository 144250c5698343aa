#pragma once

#include <span>

#include "tools/experiment/experiment.hpp"

namespace odoless {

/// What the dissertation says of accumulated errors of position (Figures 5.7 and 5.25), as predicates of the error per
/// pose.

/// Matches alone: the largest error of the last third is larger than that of the first third.
[[nodiscard]] Claim error_accumulates(std::span<const double> errors_m);
/// DP-SLAM: 90 % of the poses at least are less than 0.3 m off.
[[nodiscard]] Claim error_is_mostly_small(std::span<const double> errors_m);
/// DP-SLAM: the last third's median error is at most twice the first third's, or below half of the 0.3 m.
[[nodiscard]] Claim error_does_not_grow(std::span<const double> errors_m);
/// Our aim: 0.1 m at most, all along.
[[nodiscard]] Claim error_is_tiny(std::span<const double> errors_m);
/// DP-SLAM's largest error is smaller than that of matches alone.
[[nodiscard]] Claim filter_beats_matches(std::span<const double> filter_m, std::span<const double> matches_m);

}  // namespace odoless
