#include "tools/fault_campaign/watched_chain.hpp"

#include "firmware/stages/stage_reports.hpp"

namespace odoless::campaign {

ScanVerdict WatchedChain::process(const RawScan& raw, std::int64_t now_ns) {
  ChainStep step = chain_.process(raw, now_ns);
  enter(chain_.sensor(), sensor_);
  sensor_.open = true;
  ++sensor_.stage.scans;
  if (step.verdict != ScanVerdict::kAccepted) {
    return step.verdict;
  }
  const PoseEstimate estimate = chain_.filter().filter().estimate();
  graph_.add(chain_.frame(), step.motion, step.filter);
  last_ = step;
  ++matcher_.stage.scans;
  enter(step.motion, matcher_);
  ++filter_.stage.scans;
  enter(step.filter, estimate, chain_.filter(), filter_);
  return step.verdict;
}

}  // namespace odoless::campaign
