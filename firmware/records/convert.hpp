#pragma once

#include "core/odometry/laser_odometry.hpp"
#include "firmware/records/records.hpp"

namespace odoless {

/// Fitness of the second peak over that of the best; 0 where there is none, or one that is worse than no match at all.
[[nodiscard]] double second_peak_ratio(const MatchResult& match);

/// What the outside is told of a step. Real time: no allocation.
[[nodiscard]] MotionRecord to_record(const OdometryStep& step);

/// The step that a record was made of, as far as the filter uses it: motion, covariance, stamps, fitness, flags.
[[nodiscard]] OdometryStep to_step(const MotionRecord& record);

}  // namespace odoless
