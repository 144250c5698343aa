#pragma once

#include <span>
#include <vector>

#include "config/robot_params.hpp"
#include "tools/log/scan_log.hpp"
#include "tools/output/matches.hpp"

namespace odoless {

/// What a scan scores on itself: the most that a match of its like can, and less than 1 per return, since the points of
/// a wall scatter about its cells' means.
struct SelfScore {
  double score = 0.0;  ///< sum over the returns, each in [0, 1]
  int returns = 0;
  int beams = 0;
};

[[nodiscard]] std::vector<SelfScore> self_scores(const ScanLog& log, const RobotParams& params);

/// The seed's form of the fitness, A - score (section 5.1.3), of each match, for scans of 180 beams. It is to be 0
/// where two scans are the same, so A is what the reference scan scores on itself; a beam without return scores
/// nothing.
[[nodiscard]] std::vector<double> seed_fitness(std::span<const MatchRow> matches, std::span<const SelfScore> of_scans);

}  // namespace odoless
