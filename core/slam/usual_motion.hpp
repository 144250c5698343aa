#pragma once

#include <algorithm>
#include <cmath>

#include "core/geometry/pose2.hpp"
#include "core/slam/recovery_params.hpp"

namespace odoless {

/// How far the robot moves from scan to scan, as it has lately: what tells a robot that was carried away from one whose
/// scans are far apart.
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

  /// Whether a step is much farther than those before it.
  [[nodiscard]] bool is_unusual(const Pose2& previous_T_current) const {
    return is_beyond(previous_T_current, params_.leap_ratio * step_m_, params_.leap_ratio * step_rad_);
  }

  /// Whether a step is farther than a robot moves by itself in that time.
  [[nodiscard]] bool is_too_fast(const Pose2& previous_T_current, double period_s) const {
    return is_beyond(previous_T_current, params_.leap_mps * period_s, params_.leap_radps * period_s);
  }

  /// Whether scans follow each other so closely that one which matches or fits badly is news.
  [[nodiscard]] bool is_dense() const {
    return step_m_ <= params_.leap_ratio * params_.leap_m && step_rad_ <= params_.leap_ratio * params_.leap_rad;
  }

 private:
  [[nodiscard]] bool is_beyond(const Pose2& step, double limit_m, double limit_rad) const {
    return step.distance_m({}) > params_.leap_m + limit_m || std::abs(step.yaw_rad) > params_.leap_rad + limit_rad;
  }

  TrackingParams params_;
  double step_m_ = 0.0;
  double step_rad_ = 0.0;
};

}  // namespace odoless
