#include "core/slam/segment.hpp"

#include <cmath>

#include "core/base/check.hpp"
#include "core/geometry/pose2_covariance.hpp"
#include "core/math/elementary.hpp"

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

void RunSegment::add(const Motion& motion, const ScanFrame& scan) {
  ODOLESS_CHECK(!full());
  scans_[static_cast<std::size_t>(size_++)] = scan;
  const Pose2& last_T_next = motion.previous_T_current;
  const Pose2 start_T_next = start_T_last_ * last_T_next;
  const double travel_m = math::hypot(last_T_next.x_m, last_T_next.y_m);
  const double variance_m2 = drift_.sd_m_per_sqrt_m * drift_.sd_m_per_sqrt_m * travel_m;
  const double variance_rad2 = drift_.sd_rad_per_sqrt_m * drift_.sd_rad_per_sqrt_m * travel_m +
                               drift_.sd_rad_per_sqrt_rad * drift_.sd_rad_per_sqrt_rad * std::abs(last_T_next.yaw_rad);
  const double share = drift_.match_ratio * drift_.match_ratio;
  const Eigen::Matrix3d turn = turn_matrix(start_T_last_.yaw_rad);
  const ErrorProcess::Matrix noise = motion.error().noise;
  const Eigen::Vector3d variances(share * noise(0, 0) + variance_m2, share * noise(1, 1) + variance_m2,
                                  share * noise(2, 2) + variance_rad2);
  const Eigen::Matrix3d lever = lever_matrix(start_T_last_, start_T_next);
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

}  // namespace odoless
