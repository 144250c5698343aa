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
    constexpr double kMemory_steps = 50.0;  // one far step among as many is less than kFar_share
    const bool is_far =
        previous_T_current.distance_m({}) > params_.leap_m || std::abs(previous_T_current.yaw_rad) > params_.leap_rad;
    steps_ = std::min(steps_ + 1.0, kMemory_steps);
    far_share_ += ((is_far ? 1.0 : 0.0) - far_share_) / steps_;
  }

  /// Whether scans follow each other so closely that one which matches or fits badly is news.
  [[nodiscard]] bool is_dense() const { return far_share_ < kFar_share; }

 private:
  static constexpr double kFar_share = 0.06;  ///< of steps: one far step alone may be what is news

  TrackingParams params_;
  double steps_ = 0.0;
  double far_share_ = 0.0;
};

}  // namespace odoless
