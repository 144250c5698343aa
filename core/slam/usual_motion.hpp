#pragma once

#include <algorithm>
#include <cmath>

#include "core/geometry/pose2.hpp"
#include "core/slam/recovery_params.hpp"

namespace odoless {

/// How far the robot moves from scan to scan, as it has lately: whether scans are near enough to each other to tell a
/// robot that is lost.
///
/// Thread: owned by one thread. Real time: no allocation, constant time.
class UsualMotion {
 public:
  explicit UsualMotion(const TrackingParams& params) : params_(params) {}

  void reset() { *this = UsualMotion(params_); }

  void add(const Pose2& previous_T_current) {
    constexpr double kKept = 0.99;  // of the largest step, from scan to scan
    step_m_ = std::max(previous_T_current.distance_m({}), kKept * step_m_);
    step_rad_ = std::max(std::abs(previous_T_current.yaw_rad), kKept * step_rad_);
  }

  /// Whether scans follow each other so closely that one which matches or fits badly is news.
  [[nodiscard]] bool is_dense() const { return step_m_ <= params_.leap_m && step_rad_ <= params_.leap_rad; }

 private:
  TrackingParams params_;
  double step_m_ = 0.0;
  double step_rad_ = 0.0;
};

}  // namespace odoless
