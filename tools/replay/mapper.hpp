#pragma once

#include <optional>
#include <vector>

#include "config/robot_params.hpp"
#include "core/geometry/stamped_pose.hpp"
#include "core/grid/occupancy_map.hpp"
#include "firmware/stages/stage_chain.hpp"
#include "tools/replay/graph_run.hpp"

namespace odoless {

/// Scans in, path and map out: the daemon's stages and the pose graph on one thread. `odoless replay`, the C library
/// and the Python module are this. The same scans, parameters and random seed give the same path and map.
class Mapper {
 public:
  Mapper(const RobotParams& params, std::uint64_t seed);

  /// Before the first scan, with the graph on: goes on with a world.
  /// @param last  Where the robot was in it. @return  Whether there is room.
  [[nodiscard]] bool resume(const SubmapWorld& world, WorldUse use, const std::optional<PlaceBySubmap>& last) {
    return graph_->resume(world, use, last);
  }

  /// Takes a scan. @return  What the stages made of it; the filter's step is told in the world.
  ChainStep process(const RawScan& raw, bool is_level = true);

  /// Of the last scan that was accepted, and all before it.
  [[nodiscard]] StageChain& chain() { return *chain_; }
  /// The pose graph; null where it is off.
  [[nodiscard]] const SubmapGraph* graph() const { return graph_ ? &graph_->graph() : nullptr; }
  /// odom_T_scan of all scans that were accepted, where the graph is on.
  [[nodiscard]] const std::vector<StampedPose>& odom() const { return odom_; }
  /// Where each of them was, as known when it was taken.
  [[nodiscard]] const std::vector<StampedPose>& online_trajectory() const { return online_; }

  /// After the last scan: what is left to be done.
  void finish();
  /// Then, with the graph on: gives back the stages' memory, which the map of a large world needs. There is no chain()
  /// any more.
  void release_stages();
  /// Where each scan was, as known now.
  [[nodiscard]] std::vector<StampedPose> trajectory();
  [[nodiscard]] OccupancyMap map();

 private:
  [[nodiscard]] std::vector<StampedPose> trajectory_of_filter();

  RobotParams params_;
  std::optional<StageChain> chain_;
  std::optional<GraphRun> graph_;
  std::vector<StampedPose> odom_;
  std::vector<StampedPose> online_;
  std::vector<Pose2>
      update_T_scan_;         ///< where there is no graph: each scan's motion since the filter's update before it
  std::vector<int> updates_;  ///< and that update
  int filter_updates_ = 0;
};

}  // namespace odoless
