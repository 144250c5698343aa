#include "tools/experiment/fitness_claims.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "tools/experiment/plots.hpp"

namespace odoless {
namespace {

double share_of_peaks(std::span<const double> fitness) {
  return static_cast<double>(count_peaks(fitness)) / static_cast<double>(std::max<std::size_t>(1, fitness.size()));
}

std::string peaks_of(std::span<const double> fitness) {
  const double largest = fitness.empty() ? 0.0 : *std::max_element(fitness.begin(), fitness.end());
  return fmt::format("{} of {} above 30 ({:.1f} %), largest {:.1f}", count_peaks(fitness), fitness.size(),
                     100.0 * share_of_peaks(fitness), largest);
}

std::string gross_share_of(const MatchingSummary& s) { return fmt::format("{}: {} of {}", s.label, s.gross, s.pairs); }

}  // namespace

std::size_t count_peaks(std::span<const double> fitness) {
  return static_cast<std::size_t>(
      std::count_if(fitness.begin(), fitness.end(), [](double value) { return value >= kSeedFitnessMax; }));
}

Claim fitness_stays_below(const std::string& figure, std::span<const double> fitness) {
  return {figure, "all fitness values of D-Wing are below 30", peaks_of(fitness),
          !fitness.empty() && count_peaks(fitness) == 0};
}

Claim peaks_are_few(const std::string& figure, const std::string& stated, std::span<const double> fitness,
                    double share_max) {
  return {figure, stated, peaks_of(fitness), !fitness.empty() && share_of_peaks(fitness) <= share_max};
}

Claim sparse_scans_match_poorly(std::span<const double> fitness) {
  constexpr double kPoorShareMin = 0.1;
  return {"5.16", "scans far apart leave many poor matches (37 %)", peaks_of(fitness),
          share_of_peaks(fitness) >= kPoorShareMin};
}

Claim wide_cells_ease_convergence(const MatchingSummary& small, const MatchingSummary& wide) {
  return {"5.17", "cells of 4000 mm instead of 1000 mm, for every match, ease convergence",
          "off by more than 0.2 m or 5 deg: " + gross_share_of(small) + "; " + gross_share_of(wide),
          wide.gross < small.gross};
}

Claim second_try_needs_wide_cells(const MatchingSummary& no_try, const MatchingSummary& small,
                                  const MatchingSummary& wide) {
  return {"5.18", "scans far apart need cells of 4000 mm, for what matches poorly with 1000 mm",
          "off by more than 0.2 m or 5 deg: " + gross_share_of(no_try) + "; " + gross_share_of(small) + "; " +
              gross_share_of(wide),
          wide.gross < small.gross && wide.gross < no_try.gross};
}

}  // namespace odoless
