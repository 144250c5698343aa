#pragma once

#include <cstdint>

#include "config/robot_params.hpp"
#include "firmware/stages/filter_stage.hpp"
#include "firmware/stages/matcher_stage.hpp"
#include "firmware/stages/sensor_stage.hpp"

namespace odoless {

/// What the stages made of one scan. Where the scan was not accepted, nothing but the verdict counts.
struct ChainStep {
  ScanVerdict verdict = ScanVerdict::kAccepted;
  std::int64_t stamp_ns = 0;  ///< of the scan
  Motion motion{};
  FilterStep filter{};
  std::int64_t matcher_cpu_ns = 0;
  std::int64_t filter_cpu_ns = 0;
};

/// The daemon's stages in a plain loop: sensor, matcher and filter, one scan after the other, without threads and
/// queues. What a replay runs. The same scans, parameters and random seed give the same steps.
///
/// Thread: owned by one thread.
class StageChain {
 public:
  /// @param live  Whether scans that are late against `now_ns` are refused (SensorStage).
  StageChain(const RobotParams& params, std::uint64_t seed, bool live);

  /// @param is_level  Whether the laser was: else nothing but the sensor stage takes the scan.
  [[nodiscard]] ChainStep process(const RawScan& raw, std::int64_t now_ns, bool is_level = true);

  [[nodiscard]] const SensorStage& sensor() const { return sensor_; }
  [[nodiscard]] SensorStage& sensor() { return sensor_; }
  [[nodiscard]] FilterStage& filter() { return filter_; }
  /// Of the last scan that was accepted, as the matcher left it.
  [[nodiscard]] const ScanFrame& frame() const { return frame_; }

 private:
  SensorStage sensor_;
  MatcherStage matcher_;
  FilterStage filter_;
  ScanFrame frame_;
};

}  // namespace odoless
