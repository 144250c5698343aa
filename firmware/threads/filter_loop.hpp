#pragma once

#include <cstdint>
#include <optional>

#include "firmware/pipeline/pipeline.hpp"
#include "firmware/pipeline/pipeline_params.hpp"
#include "firmware/stages/filter_stage.hpp"
#include "firmware/threads/keyframe_sender.hpp"
#include "firmware/threads/path_sender.hpp"
#include "firmware/threads/round.hpp"
#include "firmware/threads/tile_sweep.hpp"

namespace odoless {

/// The filter thread: takes every motion in its order, updates the filter when the robot has moved, tells the publisher
/// poses and pieces of the map.
///
/// Real time: no allocation after construction; system calls: those of WakeUp, the CPU clock, and getrusage. The
/// particles adapt, so that an update keeps the budget, and a deadline ends what takes longer
/// all the same; neither in a lossless replay.
class FilterLoop {
 public:
  FilterLoop(Pipeline& pipeline, FilterStage& stage, const PipelineParams& params, double map_refresh_s);

  /// Until the stage before is done and all its motions are.
  /// @param before  Set when no motion will come any more: by the matcher, or by the sensor thread where it receives.
  void run(const std::atomic<bool>& before);

  /// Before `run`: keyframes are told, instead of the filter's own map.
  void tell_keyframes(const GraphParams& params) { keyframes_.emplace(params); }
  /// Before `run`: the trajectory is told too.
  void tell_path() { tells_path_ = true; }

 private:
  void process(const MotionMessage& message);
  void tell_keyframe(const MotionMessage& message, const FilterStep& step);
  void obey(const FilterCommand& command);
  void publish(const FilterStep& step, const Motion& motion);
  /// CPU time until an update after this match is cut short.
  [[nodiscard]] std::int64_t update_time_ns(const MotionMessage& message) const;
  void adapt(int particles, std::int64_t used_ns, std::int64_t time_ns);
  void report();

  Pipeline& pipeline_;
  FilterStage& stage_;
  PipelineParams params_;
  int particles_min_;
  double particles_;  ///< as many as the budget allows
  TileSweep tiles_;
  PathSender path_;
  std::optional<KeyframeSender> keyframes_;
  bool tells_path_ = false;
  std::int32_t map_number_ = 0;
  FilterReport report_;
  StageTimer timer_;
  ThreadMeter meter_;
};

}  // namespace odoless
