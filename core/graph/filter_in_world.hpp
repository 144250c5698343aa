#pragma once

#include <optional>
#include <span>
#include <vector>

#include "core/geometry/pose2.hpp"
#include "core/graph/submap_graph.hpp"

namespace odoless {

/// Where the particle filter's own map lies in the world, and with it the published map_T_odom: the graph's, which has
/// closed the loops; but where the robot was put elsewhere than the motions lead (it was found, or told where it is, or
/// a step may have been wrong and the filter took another one) the filter's, by the submap that the robot is at in the
/// filter's map, until the graph has it there too, or has closed a loop from beyond that. Where the filter jumps over
/// motions that were right, the graph's stays. How: core/graph/README.md.
///
/// And how sure that place is: what the odometry may have drifted since the map's beginning, or since a world that was
/// there before, along the loop closures that hold. Over a motion that is not credible the filter is taken at its word,
/// which says itself how probable it is.
///
/// Frames: map, odom; local, which is the filter's map. Memory is fixed at construction. Thread: owned by one thread.
/// `follow` takes constant time but where the robot was put elsewhere, when it is linear in the submaps.
class FilterInWorld {
 public:
  explicit FilterInWorld(const GraphParams& params);

  /// Whenever the graph may have changed.
  void update(const SubmapGraph& graph);
  /// Every scan, as the filter has it. @param placements  How often the robot was put elsewhere than the motions lead.
  /// @param unconfirmed  Recovery's. @return  map_T_odom.
  Pose2 follow(const Pose2& local_T_odom, const Pose2& odom_T_scan, int placements, int unconfirmed);
  /// Of that scan's pose: what the drift may be, over (x_m, y_m, yaw_rad) in the map's axes; what the filter itself is
  /// unsure of comes on top.
  [[nodiscard]] const Eigen::Matrix3d& drift() const { return drift_; }
  /// That it is within what OK promises. Where the robot was lost and went on without being found, a loop closure from
  /// beyond that says how what it has mapped since lies to the rest; until then nobody knows.
  [[nodiscard]] double within_ok() const;
  /// A pose of the world in the filter's own map, by the submap that is nearest to it.
  [[nodiscard]] Pose2 to_local(const Pose2& map_T_scan) const;

 private:
  struct Place {
    int serial = 0;  ///< of its first keyframe
    Pose2 map_T_submap{};
    Pose2 local_T_submap{};
    Eigen::Matrix3d drift = Eigen::Matrix3d::Zero();  ///< in the submap's axes

    [[nodiscard]] Pose2 map_T_local() const { return map_T_submap * local_T_submap.inverse(); }
  };

  /// By that submap.
  Pose2 placed(const Place& place, const Pose2& map_T_odom, const Pose2& odom_T_scan);
  /// The submap that the robot is at.
  [[nodiscard]] std::optional<std::size_t> nearest(const Pose2& local_T_scan) const;
  /// Notes which submaps there are now, and where they lie.
  void take(const SubmapGraph& graph);

  std::vector<Place> places_;  ///< of the submaps of this run
  PoseGraph::Projection projection_;
  Eigen::Matrix3d drift_ = Eigen::Matrix3d::Zero();
  Eigen::Matrix2d odom_slip_ = Eigen::Matrix2d::Zero();  ///< since the newest of them
  std::int64_t revision_ = -1;
  int thinnings_ = 0;                      ///< of the graph
  std::optional<Pose2> guess_;             ///< map_T_odom while this run is not joined to the world
  std::optional<Pose2> begin_;             ///< map_T_odom while there is no submap
  std::optional<Pose2> graph_map_T_odom_;  ///< none behind a motion that is not credible
  std::optional<int> placements_;          ///< with the scan before
  std::optional<std::size_t> claim_;      ///< since the last: the submap by which the filter has the robot in the world
  int claimed_after_ = 0;                 ///< serial of the newest submap then
  int unconfirmed_ = 0;                   ///< with the scan before
  std::optional<int> unconfirmed_after_;  ///< serial of the newest submap then, until a loop from beyond is closed
};

}  // namespace odoless
