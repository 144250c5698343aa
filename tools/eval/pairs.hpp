#pragma once

#include <numbers>
#include <span>
#include <vector>

#include "tools/eval/pose_errors.hpp"
#include "tools/eval/stamp_lookup.hpp"
#include "tools/output/matches.hpp"

namespace odoless {

struct PairsParams {
  Association association;
  double gross_translation_m = 0.2;  ///< a match that is further off is a gross failure
  double gross_rotation_rad = 5.0 * std::numbers::pi / 180.0;
};

struct PairError {
  MatchRow row;
  PoseError error;
};

struct PairsResult {
  PoseErrorStatistics errors;          ///< of all rows used
  PoseErrorStatistics errors_of_good;  ///< of those that are no gross failures
  std::size_t used = 0;
  std::size_t missing = 0;  ///< rows of which the reference lacks a pose
  std::size_t gross = 0;
  double converged_share = 0.0;  ///< 0..1 of all rows
  Statistics time_us;            ///< of all rows
  std::vector<PairError> worst;  ///< at most 5, the worst first, measured in the limits of a gross failure
};

/// Compares every match with the reference's motion between the same two scans; these are found by stamp, or by index
/// when the reference is a log whose stamps tell nothing.
[[nodiscard]] PairsResult evaluate_pairs(const ReferencePoses& reference, std::span<const MatchRow> rows,
                                         const PairsParams& params);

}  // namespace odoless
