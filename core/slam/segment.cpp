#include "core/slam/segment.hpp"

#include <cmath>

#include "core/base/check.hpp"

namespace odoless {

RunSegment::RunSegment(const DriftParams& drift, int scans_max, int low_particles_max, const ScanParams& scan)
    : drift_(drift),
      scans_(static_cast<std::size_t>(scans_max), ScanFrame(scan)),
      start_T_scans_(static_cast<std::size_t>(scans_max) * static_cast<std::size_t>(low_particles_max)),
      path_weights_(static_cast<std::size_t>(low_particles_max)),
      last_(static_cast<std::size_t>(scans_max) + 1) {}

void RunSegment::clear() {
  size_ = paths_ = 0;
  start_T_last_ = Pose2{};
  covariance_.setZero();
}

void RunSegment::add(const MotionIncrement& increment, const ScanFrame& scan) {
  ODOLESS_CHECK(!full());
  scans_[static_cast<std::size_t>(size_++)] = scan;
  const Pose2 start_T_next = start_T_last_ * increment.previous_T_current;
  const Pose2& motion = increment.previous_T_current;
  const double travel_m = std::hypot(motion.x_m, motion.y_m);
  const double variance_m2 = std::pow(drift_.sd_m_per_sqrt_m, 2) * travel_m;
  const double variance_rad2 = std::pow(drift_.sd_rad_per_sqrt_m, 2) * travel_m +
                               std::pow(drift_.sd_rad_per_sqrt_rad, 2) * std::abs(motion.yaw_rad);
  const double share = std::pow(drift_.match_ratio, 2);
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  const double c = std::cos(start_T_last_.yaw_rad);
  const double s = std::sin(start_T_last_.yaw_rad);
  turn.topLeftCorner<2, 2>() << c, -s, s, c;
  const Eigen::Vector3d variances(share * increment.error.noise(0, 0) + variance_m2,
                                  share * increment.error.noise(1, 1) + variance_m2,
                                  share * increment.error.noise(2, 2) + variance_rad2);
  // What the heading was off before turns this motion.
  Eigen::Matrix3d lever = Eigen::Matrix3d::Identity();
  lever(0, 2) = start_T_last_.y_m - start_T_next.y_m;
  lever(1, 2) = start_T_next.x_m - start_T_last_.x_m;
  covariance_ = (lever * covariance_ * lever.transpose() + turn * variances.asDiagonal() * turn.transpose()).eval();
  start_T_last_ = start_T_next;
}

void RunSegment::close(const Lslam& low) {
  ODOLESS_CHECK(size_ > 0);
  paths_ = low.particles();
  for (int path = 0; path < paths_; ++path) {
    const auto p = static_cast<std::size_t>(path);
    path_weights_[p] = low.weight(path);
    const auto wanted = static_cast<std::size_t>(size_) + 1;
    const int found = low.copy_last_poses(path, std::span(last_).first(wanted));
    ODOLESS_CHECK(found >= size_);
    const Pose2 start_T_map = last_[0].map_T_scan.inverse();
    for (int i = 0; i < size_; ++i) {
      const int index = found - size_ + i;
      start_T_scans_[p * scans_.size() + static_cast<std::size_t>(i)] =
          start_T_map * last_[static_cast<std::size_t>(index)].map_T_scan;
    }
  }
}

Pose2 RunSegment::scan_pose(int path, int index, const Eigen::Vector3d& drift) const {
  const Pose2& pose = start_T_scans_[static_cast<std::size_t>(path) * scans_.size() + static_cast<std::size_t>(index)];
  const double share = static_cast<double>(index + 1) / size_;
  return {pose.x_m + share * drift.x(), pose.y_m + share * drift.y(), wrap_angle(pose.yaw_rad + share * drift.z())};
}

std::size_t RunSegment::memory_bytes() const {
  std::size_t bytes = start_T_scans_.capacity() * sizeof(Pose2) + path_weights_.capacity() * sizeof(double) +
                      last_.capacity() * sizeof(StampedPose);
  for (const ScanFrame& scan : scans_) {
    bytes += sizeof(ScanFrame) + scan.memory_bytes();
  }
  return bytes;
}

}  // namespace odoless
