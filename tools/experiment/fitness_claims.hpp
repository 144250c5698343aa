#pragma once

#include <span>
#include <string>

#include "tools/experiment/experiment.hpp"
#include "tools/experiment/measures.hpp"

namespace odoless {

/// What the dissertation says of the fitness on recorded logs (section 5.1.3), as predicates of the matches' fitness in
/// its form (self_fitness.hpp), and of their errors.

/// How many matches are at or above the dissertation's threshold of 30.
[[nodiscard]] std::size_t count_peaks(std::span<const double> fitness);

[[nodiscard]] Claim fitness_stays_below(const std::string& figure, std::span<const double> fitness);
/// At most this share of the matches is above the threshold.
[[nodiscard]] Claim peaks_are_few(const std::string& figure, const std::string& stated, std::span<const double> fitness,
                                  double share_max);
/// Matches of scans far apart: at least a tenth is poor with small cells.
[[nodiscard]] Claim sparse_scans_match_poorly(std::span<const double> fitness);
/// Wide cells for every match leave fewer gross failures than small ones.
[[nodiscard]] Claim wide_cells_ease_convergence(const MatchingSummary& small, const MatchingSummary& wide);
/// What is tried again where it matched poorly fails less often than what is not, and least often with wide cells.
[[nodiscard]] Claim second_try_needs_wide_cells(const MatchingSummary& no_try, const MatchingSummary& small,
                                                const MatchingSummary& wide);

}  // namespace odoless
