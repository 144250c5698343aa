#pragma once

#include <span>
#include <vector>

#include "tools/experiment/experiment.hpp"
#include "tools/experiment/measures.hpp"

namespace odoless {

/// What the dissertation says of the errors of matches (section 5.2), as predicates of them.

/// A deviation that grows with the displacement, as the motion model's spreads do: floor + ratio * |displacement|.
struct SpreadLaw {
  double floor = 0.0;
  double ratio = 0.0;
};

/// Least squares of the absolute errors, each 0.798 of the deviation on average, over the absolute displacements.
[[nodiscard]] SpreadLaw fit_spread(std::span<const double> displacements, std::span<const double> errors);

/// Figure 5.19: within 2 robust deviations lie 90 to 99 % of the errors, as of a normal law's 95 %.
[[nodiscard]] Claim errors_look_normal(const char* figure, const char* axis, std::span<const double> errors);
/// Figure 5.19: the fitted constants, converted to the dissertation's spreads, are within those of its Table 5.1.
[[nodiscard]] Claim spreads_cover_errors(std::span<const DisplacementError> errors);

/// Figure 5.23: of the quarter of the matches that travel most, the median rotation is below that of all.
[[nodiscard]] Claim long_displacements_turn_little(std::span<const MatchRow> matches);

/// Figure 5.21: along a featureless corridor the match reports much less travel than there was, so that the error is
/// about -lambda.
[[nodiscard]] Claim corridor_hides_travel(std::span<const DisplacementError> errors);
/// The same scene constrains the other axis and the heading.
[[nodiscard]] Claim corridor_holds_across(std::span<const DisplacementError> errors);

}  // namespace odoless
