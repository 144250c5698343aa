#include "firmware/stages/matcher_stage.hpp"

namespace odoless {

MatcherStage::MatcherStage(const RobotParams& params, std::uint64_t seed)
    : odometry_(params.odometry, params.limits, params.matcher, params.scan), rng_(seed, 1) {}

Motion MatcherStage::process(ScanFrame& scan, const Deadline& deadline) {
  return odometry_.process(scan, deadline, rng_);
}

}  // namespace odoless
