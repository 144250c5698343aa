#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

#include "core/geometry/pose2.hpp"

namespace odoless {

/// A covariance in this folder is that of a small motion of the later frame, over (x_m, y_m, yaw_rad) in its own axes:
/// a_T_b is a_T_b * error.

/// Covariance of a_T_c = a_T_b * b_T_c where only a_T_b errs.
[[nodiscard]] Eigen::Matrix3d carried(const Eigen::Matrix3d& covariance_ab, const Pose2& b_T_c);
/// Covariance of b_T_a, of that of a_T_b.
[[nodiscard]] Eigen::Matrix3d inverted(const Eigen::Matrix3d& covariance_ab, const Pose2& a_T_b);
/// measured^-1 * expected as (x_m, y_m, yaw_rad): the error of a measured pose, in its axes.
[[nodiscard]] Eigen::Vector3d error_between(const Pose2& measured, const Pose2& expected);

/// What is known of the pose of one submap in another's frame.
struct Constraint {
  int from = 0;
  int to = 0;
  Pose2 from_T_to{};
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< what a search for a loop must allow for
  Eigen::Matrix2d map_slip = Eigen::Matrix2d::Zero();    ///< OdometryStretch's, in the axes of `to`
  bool is_loop = false;                                  ///< a loop closure, which may be wrong; else odometry
  bool is_new = false;                                   ///< since the last solution
  bool is_break = false;                                 ///< odometry over a motion that is not credible
  double weight = 1.0;  ///< that robust least squares give a loop closure; 0: taken out

  /// Whether one may rely on it: odometry, or a loop closure that the others don't contradict.
  [[nodiscard]] bool holds() const { return !is_loop || weight >= 0.3; }
  /// How far off it is expected to be, in the axes of its covariance. Nothing over a break, for which the filter
  /// vouches.
  [[nodiscard]] Eigen::Matrix3d drift() const;
};

/// Poses of submaps and the constraints between them.
///
/// Frames: map, which begins at node 0. Thread: owned by one thread. Memory is fixed at construction.
class PoseGraph {
 public:
  /// Covariance of each node as seen from one node, along the path that errs least.
  struct Projection {
    std::vector<Eigen::Matrix3d> covariances;
    std::vector<double> costs;  ///< kUnreached where there is no path
  };
  static constexpr double kUnreached = 1e18;

  PoseGraph(int nodes_max, int constraints_max);

  [[nodiscard]] int size() const { return static_cast<int>(poses_.size()); }
  [[nodiscard]] bool full() const { return poses_.size() == nodes_max_; }
  [[nodiscard]] bool has_room(int constraints) const {
    return constraints_.size() + static_cast<std::size_t>(constraints) <= constraints_max_;
  }
  /// Only when not full. @return  Its index.
  int add_node(const Pose2& map_T_node);
  /// Only when there is room.
  void add(const Constraint& constraint);

  /// Number of the nodes that are joined by constraints, whichever these are: the first one of them.
  [[nodiscard]] int component(int node) const { return components_[static_cast<std::size_t>(node)]; }
  /// Whether odometry leads to a node from the one before.
  [[nodiscard]] bool follows(int node) const;
  /// The component with the most nodes; 0 without any.
  [[nodiscard]] int largest_component() const;
  /// Moves all nodes of a component as one.
  void move(int component, const Pose2& new_T_map);

  /// The first so many nodes stay where they are, whatever is solved.
  void hold(int nodes) { held_ = nodes; }
  [[nodiscard]] int held() const { return held_; }
  /// Takes out nodes with all of their constraints; those behind them have lower numbers. Linear in the graph.
  void erase(int first, int count);
  /// Takes out all.
  void clear() { erase(0, size()); }

  [[nodiscard]] const Pose2& pose(int node) const { return poses_[static_cast<std::size_t>(node)]; }
  [[nodiscard]] Pose2 between(int from, int to) const { return pose(from).inverse() * pose(to); }
  [[nodiscard]] std::span<Pose2> poses() { return poses_; }
  [[nodiscard]] std::span<const Pose2> poses() const { return poses_; }
  [[nodiscard]] std::span<Constraint> constraints() { return constraints_; }
  [[nodiscard]] std::span<const Constraint> constraints() const { return constraints_; }

  /// Dijkstra's shortest paths by the trace of the covariance [bosse2003atlas, section III-C; method 9]. Loop closures
  /// that don't hold lead nowhere. Time: n log n in the constraints.
  void project(int root, Projection& out) const;
  /// The drift alone: the same from the nearest of several nodes, whose poses are certain, and breaks add nothing.
  void project_drift(int begin, int end, Projection& out) const;

 private:
  static constexpr int kNone = -1;
  struct Links {
    int after_from = kNone;  ///< next constraint of the same node
    int after_to = kNone;
  };

  void project(int begin, int end, bool of_drift, Projection& out) const;

  std::size_t nodes_max_;
  std::size_t constraints_max_;
  int held_ = 0;
  std::vector<Pose2> poses_;
  std::vector<int> components_;
  std::vector<int> first_;  ///< constraint of each node
  std::vector<Constraint> constraints_;
  std::vector<Links> links_;
};

}  // namespace odoless
