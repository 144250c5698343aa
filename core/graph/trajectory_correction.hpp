#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include "core/geometry/stamped_pose.hpp"

namespace odoless {

/// Where a submap lies in the odometry of its run, and in the world.
struct SubmapPlace {
  Pose2 odom_T_submap{};
  Pose2 map_T_submap{};
  std::int64_t origin_stamp_ns = 0;
};

/// Where the poses of a trajectory were, as a pose graph knows it: between two submaps' origins a correction goes in
/// with the travel. The trajectory is handed over twice, piece by piece, so that it may be of any length. Poses may
/// lack: a submap whose origin is not among them corrects none.
///
/// Thread: owned by one thread; it keeps nothing of the graph that it was made of.
class TrajectoryCorrection {
 public:
  /// Each of the trajectory's submaps, in their order.
  void add(const SubmapPlace& submap);
  /// Then, all pieces in their order. @param odom  odom_T_scan of all scans, keyframes and others.
  void survey(std::span<const StampedPose> odom);
  /// In the end all of them again: each becomes map_T_scan.
  void correct(std::span<StampedPose> poses);

 private:
  /// A submap whose origin is a pose of the trajectory.
  struct Anchor {
    std::size_t place = 0;
    std::int64_t stamp_ns = 0;
    double travel_m = 0.0;
  };
  /// The travel until a pose.
  class Travel {
   public:
    double to(const Pose2& odom_T_scan);

   private:
    Pose2 before_{};
    double travel_m_ = 0.0;
    bool has_begun_ = false;
  };

  [[nodiscard]] Pose2 seen_from(const Anchor& anchor, const Pose2& odom_T_scan) const;

  std::vector<SubmapPlace> places_;
  std::unordered_map<std::int64_t, std::size_t> place_at_ns_;  ///< by the stamp of its origin
  std::vector<Anchor> anchors_;
  Travel survey_;
  std::size_t passed_ = 0;  ///< anchors
  Travel travel_;
};

}  // namespace odoless
