#pragma once

#include <cmath>
#include <numbers>

#include "core/math/elementary.hpp"

namespace odoless {

struct Point2 {
  double x_m = 0.0;
  double y_m = 0.0;
};

/// The angle's equal in (-pi, pi].
[[nodiscard]] inline double wrap_angle(double angle_rad) {
  const double wrapped_rad = std::remainder(angle_rad, 2.0 * std::numbers::pi);
  return wrapped_rad <= -std::numbers::pi ? std::numbers::pi : wrapped_rad;
}

/// Rigid transform of the plane, SE(2). `a_T_b` takes coordinates in frame b to frame a, and frames cancel:
/// a_T_c = a_T_b * b_T_c and p_a = a_T_b * p_b. Yaw is counter-clockwise, x forward, y left (REP-103).
struct Pose2 {
  double x_m = 0.0;
  double y_m = 0.0;
  double yaw_rad = 0.0;

  [[nodiscard]] Pose2 inverse() const {
    const auto [s, c] = math::sincos(yaw_rad);
    return {-c * x_m - s * y_m, s * x_m - c * y_m, wrap_angle(-yaw_rad)};
  }

  [[nodiscard]] double distance_m(const Pose2& other) const { return math::hypot(x_m - other.x_m, y_m - other.y_m); }
};

[[nodiscard]] inline Point2 operator*(const Pose2& a_T_b, const Point2& p_b) {
  const auto [s, c] = math::sincos(a_T_b.yaw_rad);
  return {a_T_b.x_m + c * p_b.x_m - s * p_b.y_m, a_T_b.y_m + s * p_b.x_m + c * p_b.y_m};
}

[[nodiscard]] inline Pose2 operator*(const Pose2& a_T_b, const Pose2& b_T_c) {
  const Point2 p_a = a_T_b * Point2{b_T_c.x_m, b_T_c.y_m};
  return {p_a.x_m, p_a.y_m, wrap_angle(a_T_b.yaw_rad + b_T_c.yaw_rad)};
}

/// Whether two poses in one frame are nearer to each other than a distance and a turn.
[[nodiscard]] inline bool are_within(const Pose2& a, const Pose2& b, double distance_m, double turn_rad) {
  return a.distance_m(b) < distance_m && std::abs(wrap_angle(a.yaw_rad - b.yaw_rad)) < turn_rad;
}

}  // namespace odoless
