#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "core/geometry/stamped_pose.hpp"
#include "core/graph/trajectory_correction.hpp"
#include "firmware/publisher/pose_spool.hpp"

namespace odoless {

/// A trajectory, read once, piece by piece: however long it is, it takes the memory of one piece.
///
/// Thread: owned by one thread; the spool must outlive it.
class PoseStream {
 public:
  /// What a trajectory is made of the poses that were kept; called for all of them in their order.
  using Change = std::function<void(std::span<const PoseSpool::Entry>, std::span<StampedPose>)>;

  PoseStream() = default;  ///< none
  /// @param size  Of the spool's poses, so many.
  PoseStream(const PoseSpool& spool, std::size_t size, Change change);

  [[nodiscard]] std::size_t size() const { return size_; }
  /// Valid until the next call; empty: that was all, or `error`.
  [[nodiscard]] std::span<const StampedPose> next();
  /// errno for which there is no more; 0: none.
  [[nodiscard]] int error() const { return error_; }

 private:
  const PoseSpool* spool_ = nullptr;
  std::size_t size_ = 0;
  std::size_t at_ = 0;
  int error_ = 0;
  Change change_;
  std::vector<PoseSpool::Entry> entries_;
  std::vector<StampedPose> poses_;
};

/// As they were published at the time.
void take_online(std::span<const PoseSpool::Entry> entries, std::span<StampedPose> poses);
/// odom_T_scan of each, in place of map_T_scan.
void take_odometry(std::span<const PoseSpool::Entry> entries, std::span<StampedPose> poses);
/// As the filter knows them at the end: each pose hangs on a filter update, and `path` says where that was. Poses whose
/// update is not in the path stay as they were published.
[[nodiscard]] PoseStream::Change take_final(std::vector<StampedPose> path);
/// As the pose graph has them. @param correction  Has surveyed the odometry.
[[nodiscard]] PoseStream::Change take_corrected(TrajectoryCorrection correction);

}  // namespace odoless
