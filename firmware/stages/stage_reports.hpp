#pragma once

#include "core/motion/motion.hpp"
#include "firmware/pipeline/messages.hpp"
#include "firmware/records/records.hpp"
#include "firmware/stages/filter_stage.hpp"
#include "firmware/stages/sensor_stage.hpp"

namespace odoless {

/// Enters what a stage knows of itself into its report; what its thread, queue and device know is theirs to enter.
///
/// Thread: that of the stage. Real time: no allocation; linear in the particles.
void enter(const SensorStage& stage, SensorReport& report);
/// @param report  Has counted this scan (`stage.scans`).
void enter(const Motion& motion, MatcherReport& report);
/// What is published of a step. @param estimate  The filter's, after it.
[[nodiscard]] PoseRecord pose_record_of(const FilterStep& step, const PoseEstimate& estimate, FilterStage& stage,
                                        std::int64_t stamp_ns);
/// @param estimate  The filter's, after this step.
void enter(const FilterStep& step, const PoseEstimate& estimate, FilterStage& stage, FilterReport& report);

}  // namespace odoless
