#pragma once

#include <span>
#include <string>

#include "tools/experiment/experiment.hpp"
#include "tools/experiment/measures.hpp"

namespace odoless {

/// What the seed says of the fitness on recorded logs (section 5.1.3), as predicates of the matches.

/// How many matches are at or above the seed's threshold of 30.
[[nodiscard]] std::size_t count_peaks(std::span<const MatchRow> matches);

[[nodiscard]] Claim fitness_stays_below(const std::string& figure, std::span<const MatchRow> matches);
/// At most this share of the matches is above the threshold.
[[nodiscard]] Claim peaks_are_few(const std::string& figure, const std::string& stated,
                                  std::span<const MatchRow> matches, double share_max);
/// Matches of scans far apart: at least a tenth is poor with small cells.
[[nodiscard]] Claim sparse_scans_match_poorly(std::span<const MatchRow> matches);
/// Wide cells leave fewer poor matches and fewer gross failures than small ones.
[[nodiscard]] Claim wide_cells_ease_convergence(const MatchingSummary& small, const MatchingSummary& wide);
/// What tries again with wide cells and a wider box has fewer gross failures than either.
[[nodiscard]] Claim escalation_helps(const MatchingSummary& small, const MatchingSummary& wide,
                                     const MatchingSummary& escalating);

}  // namespace odoless
