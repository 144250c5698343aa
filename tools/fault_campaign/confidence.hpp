#pragma once

#include "firmware/records/health.hpp"
#include "firmware/stages/filter_stage.hpp"

namespace odoless::campaign {

/// Probability, as the daemon says it, that the published pose is within 0.5 m and 5 deg.
[[nodiscard]] inline double said_probability(HealthState state, const FilterStep& /*step*/) {
  switch (state) {
    case HealthState::kOk:
      return 0.99;
    case HealthState::kDegraded:
      return 0.5;
    default:
      return 0.02;
  }
}

}  // namespace odoless::campaign
