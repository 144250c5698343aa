#pragma once

#include <cstdint>

#include "firmware/health/health_monitor.hpp"
#include "firmware/stages/stage_chain.hpp"
#include "tools/replay/graph_run.hpp"

namespace odoless::campaign {

/// The daemon without its threads: the stages, the pose graph, and the health report made of what they say of
/// themselves.
///
/// A copy goes on from where the original was.
class WatchedChain {
 public:
  WatchedChain(const RobotParams& params, std::uint64_t seed, bool live)
      : chain_(params, seed, live), graph_(params, seed), monitor_(HealthParams{}) {}

  /// A scan arrives.
  ScanVerdict process(const RawScan& raw, std::int64_t now_ns);
  /// What the daemon would publish now.
  [[nodiscard]] const HealthReport& health(std::int64_t now_ns) {
    return monitor_.update(sensor_, matcher_, filter_, {}, now_ns);
  }

  /// Of the last scan that was accepted.
  [[nodiscard]] const ChainStep& last() const { return last_; }
  [[nodiscard]] bool has_pose() const { return filter_.stage.scans > 0; }
  [[nodiscard]] FilterStage& filter() { return chain_.filter(); }

 private:
  StageChain chain_;
  GraphRun graph_;
  HealthMonitor monitor_;
  SensorReport sensor_;
  MatcherReport matcher_;
  FilterReport filter_;
  ChainStep last_;
};

}  // namespace odoless::campaign
