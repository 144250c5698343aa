#pragma once

#include "firmware/records/health.hpp"
#include "firmware/stages/filter_stage.hpp"

namespace odoless::campaign {

/// Probability, as the daemon says it, that the published pose is within 0.5 m and 5 deg.
[[nodiscard]] inline double said_probability(HealthState state, const FilterStep& step) {
  return state == HealthState::kLost || state == HealthState::kFault ? 0.0 : step.probability;
}

}  // namespace odoless::campaign
