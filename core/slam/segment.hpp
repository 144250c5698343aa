#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "core/motion/motion.hpp"
#include "core/scan/scan_frame.hpp"
#include "core/slam/hslam_params.hpp"
#include "core/slam/lslam.hpp"

namespace odoless {

/// A stretch of the low level's run: its scans, the paths that its particles took, and how far these may be off.
///
/// Frames:    `start` is the scan frame of the last update before the segment; of the first update for the first
///            segment.
/// Thread:    owned by one thread.
/// Real time: no allocation after construction; `close` is linear in low-level particles times scans.
class RunSegment {
 public:
  RunSegment(const DriftParams& drift, int scans_max, int low_particles_max, const ScanParams& scan);

  void clear();
  /// Takes the scan of an update; not when full.
  /// @param motion  From the scan before.
  void add(const Motion& motion, const ScanFrame& scan);
  /// Takes the paths, once all scans are there.
  void close(const Lslam& low);

  [[nodiscard]] int size() const { return size_; }
  [[nodiscard]] bool full() const { return size_ == static_cast<int>(scans_.size()); }
  [[nodiscard]] const ScanFrame& scan(int index) const { return scans_[static_cast<std::size_t>(index)]; }

  /// Low-level particles, and their weights of sum 1.
  [[nodiscard]] int paths() const { return paths_; }
  [[nodiscard]] double path_weight(int path) const { return path_weights_[static_cast<std::size_t>(path)]; }
  /// Pose of a scan on a path whose end is off by `drift` over (x_m, y_m, yaw_rad) in the start's axes; the drift grows
  /// evenly from scan to scan.
  [[nodiscard]] Pose2 scan_pose(int path, int index, const Eigen::Vector3d& drift) const;
  /// Covariance of the drift of the end.
  [[nodiscard]] const Eigen::Matrix3d& drift_covariance() const { return covariance_; }

 private:
  DriftParams drift_;
  std::vector<ScanFrame> scans_;
  std::vector<Pose2> start_T_scans_;  ///< path by path
  std::vector<double> path_weights_;
  std::vector<StampedPose> last_;
  int size_ = 0;
  int paths_ = 0;
  Pose2 start_T_last_;  ///< by the motions
  Eigen::Matrix3d covariance_ = Eigen::Matrix3d::Zero();
};

}  // namespace odoless
