#pragma once

#include "core/odometry/laser_odometry.hpp"
#include "firmware/records/records.hpp"

namespace odoless {

/// What the outside is told of a step. Real time: no allocation.
[[nodiscard]] MotionRecord to_record(const OdometryStep& step);

/// The step that a record was made of, as far as the filter uses it: motion, covariance, stamps, fitness, flags.
[[nodiscard]] OdometryStep to_step(const MotionRecord& record);

}  // namespace odoless
