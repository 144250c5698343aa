#pragma once

#include <optional>
#include <vector>

#include "config/robot_params.hpp"
#include "core/graph/filter_in_world.hpp"
#include "core/graph/keyframe_gate.hpp"
#include "core/graph/submap_graph.hpp"
#include "firmware/stages/filter_stage.hpp"

namespace odoless {

/// The pose graph beside the stages of a replay, on the scans and motions that they have.
class GraphRun {
 public:
  GraphRun(const RobotParams& params, std::uint64_t seed)
      : gate_(params.graph),
        graph_(params.graph, params.limits, params.scan, seed),
        place_(params.graph),
        sure_probability_(params.recovery.tracking.sure_probability) {}

  /// Before the first scan: goes on with a world. @param last  Where the robot was in it. @return  Whether there is
  /// room.
  [[nodiscard]] bool resume(const SubmapWorld& world, WorldUse use, const std::optional<PlaceBySubmap>& last) {
    const bool has_room = graph_.resume(world, use);
    if (last) {
      graph_.expect(*last);
    }
    return has_room;
  }

  /// Every scan and what the stages made of it. @param step  As the filter has it in its own map; in the world then.
  void add(const ScanFrame& scan, const Motion& motion, FilterStep& step) {
    if (gate_.add(motion, step.unknown_s)) {
      Keyframe keyframe;
      codes_.resize(static_cast<std::size_t>(gate_.beams(scan)));
      gate_.encode(scan, step.map_T_odom, keyframe, codes_);
      gate_.accept();
      for (bool is_at_work = graph_.add(keyframe, codes_); is_at_work; is_at_work = graph_.work()) {
      }
    }
    place_.update(graph_);
    step.map_T_odom = place_.follow(step.map_T_odom, motion.odom_T_current, step.placements, step.unconfirmed);
    step.map_T_scan = step.map_T_odom * motion.odom_T_current;
    step.drift = place_.drift();
    step.probability *= place_.within_ok();
    step.has_drifted = step.tracking == Tracking::kSure && place_.within_ok() < sure_probability_;
    step.tracking = step.has_drifted ? Tracking::kDoubtful : step.tracking;
  }

  /// When the run is over.
  void finish() { graph_.finish(); }
  [[nodiscard]] const SubmapGraph& graph() const { return graph_; }

 private:
  KeyframeGate gate_;
  SubmapGraph graph_;
  FilterInWorld place_;
  double sure_probability_;
  std::vector<BeamCode> codes_;
};

}  // namespace odoless
