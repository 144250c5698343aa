#pragma once

#include <span>

#include "tools/experiment/experiment.hpp"
#include "tools/experiment/measures.hpp"

namespace odoless {

/// What the dissertation says of matching in section 5.1.1 and 5.1.2, and our own aims, as predicates of the measured
/// errors. Each summary is of the same pairs matched with another setting; sets are in the order of that setting.

[[nodiscard]] Claim small_populations_do_not_converge(std::span<const MatchingSummary> small);
[[nodiscard]] Claim large_populations_have_fewer_and_lower_peaks(std::span<const MatchingSummary> small,
                                                                 std::span<const MatchingSummary> large);
[[nodiscard]] Claim population_converges(const MatchingSummary& large);
/// Our aim: median of 10 mm and 0.1 deg at most, nothing above 0.2 m.
[[nodiscard]] Claim displacement_is_exact(const MatchingSummary& summary);

[[nodiscard]] Claim generations_refine(std::span<const MatchingSummary> by_generations);
/// Of 15 and 30 generations: converged, and not yet as exact as with more.
[[nodiscard]] Claim few_generations_converge_unrefined(std::span<const MatchingSummary> few,
                                                       std::span<const MatchingSummary> many);

[[nodiscard]] Claim error_grows_with_noise(std::span<const MatchingSummary> by_noise);
[[nodiscard]] Claim noise_is_survived(std::span<const MatchingSummary> by_noise);
/// Our aim: a smaller median error at every noise, in no more time.
[[nodiscard]] Claim default_beats_seed(std::span<const MatchingSummary> seed, std::span<const MatchingSummary> ours);
/// Our aim: a smaller RMS error, which the few worst matches make, at every noise.
[[nodiscard]] Claim default_beats_seed_at_worst(std::span<const MatchingSummary> seed,
                                                std::span<const MatchingSummary> ours);

}  // namespace odoless
