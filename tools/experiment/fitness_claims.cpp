#include "tools/experiment/fitness_claims.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "tools/experiment/plots.hpp"

namespace odoless {
namespace {

double share_of_peaks(std::span<const MatchRow> matches) {
  return static_cast<double>(count_peaks(matches)) / static_cast<double>(std::max<std::size_t>(1, matches.size()));
}

std::string peaks_of(std::span<const MatchRow> matches) {
  double largest = 0.0;
  for (const MatchRow& match : matches) {
    largest = std::max(largest, seed_fitness(match));
  }
  return fmt::format("{} of {} above 30 ({:.1f} %), largest {:.1f}", count_peaks(matches), matches.size(),
                     100.0 * share_of_peaks(matches), largest);
}

std::string gross_of(const MatchingSummary& s) { return fmt::format("{}: {} of {}", s.label, s.gross, s.pairs); }

}  // namespace

std::size_t count_peaks(std::span<const MatchRow> matches) {
  return static_cast<std::size_t>(std::count_if(
      matches.begin(), matches.end(), [](const MatchRow& match) { return seed_fitness(match) >= kSeedFitnessMax; }));
}

Claim fitness_stays_below(const std::string& figure, std::span<const MatchRow> matches) {
  return {figure, "all fitness values of D-Wing are below 30", peaks_of(matches),
          !matches.empty() && count_peaks(matches) == 0};
}

Claim peaks_are_few(const std::string& figure, const std::string& stated, std::span<const MatchRow> matches,
                    double share_max) {
  return {figure, stated, peaks_of(matches), !matches.empty() && share_of_peaks(matches) <= share_max};
}

Claim sparse_scans_match_poorly(std::span<const MatchRow> matches) {
  constexpr double kPoorShareMin = 0.1;
  return {"5.16", "scans far apart leave many poor matches (37 %)", peaks_of(matches),
          share_of_peaks(matches) >= kPoorShareMin};
}

Claim wide_cells_ease_convergence(const MatchingSummary& small, const MatchingSummary& wide) {
  return {"5.17", "cells of 4000 mm instead of 1000 mm ease convergence",
          "off by more than 0.2 m or 5 deg: " + gross_of(small) + "; " + gross_of(wide), wide.gross < small.gross};
}

Claim escalation_helps(const MatchingSummary& small, const MatchingSummary& wide, const MatchingSummary& escalating) {
  return {"5.18", "poor matches tried again one by one, with another search space, give the map",
          "off by more than 0.2 m or 5 deg: " + gross_of(escalating),
          escalating.gross < small.gross && escalating.gross < wide.gross};
}

}  // namespace odoless
