#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "core/geometry/pose2.hpp"
#include "core/math/elementary.hpp"

namespace odoless {

struct Point3 {
  double x_m = 0.0;
  double y_m = 0.0;
  double z_m = 0.0;
};

/// Rigid transform of space, SE(3). Frames cancel as with Pose2. x forward, y left, z up (REP-103).
struct Pose3 {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d origin_m = Eigen::Vector3d::Zero();

  /// Turned by `roll` about x, then by `pitch` about y, then by `yaw` about z, all of the fixed axes (REP-103).
  [[nodiscard]] static Pose3 of(const Point3& origin, double roll_rad, double pitch_rad, double yaw_rad) {
    const auto [sr, cr] = math::sincos(roll_rad);
    const auto [sp, cp] = math::sincos(pitch_rad);
    const auto [sy, cy] = math::sincos(yaw_rad);
    Eigen::Matrix3d turn;
    turn << cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr,  //
        sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr,      //
        -sp, cp * sr, cp * cr;
    return {turn, {origin.x_m, origin.y_m, origin.z_m}};
  }

  /// A pose in the plane z = 0.
  [[nodiscard]] static Pose3 of(const Pose2& pose) { return of({pose.x_m, pose.y_m, 0.0}, 0.0, 0.0, pose.yaw_rad); }

  [[nodiscard]] Pose3 inverse() const { return {rotation.transpose(), -(rotation.transpose() * origin_m)}; }
};

[[nodiscard]] inline Point3 operator*(const Pose3& a_T_b, const Point3& p_b) {
  const Eigen::Vector3d p_a = a_T_b.rotation * Eigen::Vector3d(p_b.x_m, p_b.y_m, p_b.z_m) + a_T_b.origin_m;
  return {p_a.x(), p_a.y(), p_a.z()};
}

[[nodiscard]] inline Pose3 operator*(const Pose3& a_T_b, const Pose3& b_T_c) {
  return {a_T_b.rotation * b_T_c.rotation, a_T_b.rotation * b_T_c.origin_m + a_T_b.origin_m};
}

}  // namespace odoless
