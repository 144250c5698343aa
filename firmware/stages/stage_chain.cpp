#include "firmware/stages/stage_chain.hpp"

#include "rt/cpu_clock.hpp"

namespace odoless {

StageChain::StageChain(const RobotParams& params, std::uint64_t seed, bool live)
    : sensor_(live, params.scan.beams_max, params.mount),
      matcher_(params, seed),
      filter_(params, seed),
      frame_(params.scan) {}

ChainStep StageChain::process(const RawScan& raw, std::int64_t now_ns, bool is_level) {
  ChainStep step{.verdict = sensor_.process(raw, now_ns, frame_), .stamp_ns = raw.stamp_ns};
  if (step.verdict == ScanVerdict::kAccepted && !is_level) {
    step.verdict = ScanVerdict::kNotLevel;
  }
  if (step.verdict != ScanVerdict::kAccepted) {
    return step;
  }
  const std::int64_t start_ns = thread_cpu_ns();
  step.motion = matcher_.process(frame_);
  const std::int64_t matched_ns = thread_cpu_ns();
  step.filter = filter_.process(frame_, step.motion);
  step.matcher_cpu_ns = matched_ns - start_ns;
  step.filter_cpu_ns = thread_cpu_ns() - matched_ns;
  return step;
}

}  // namespace odoless
