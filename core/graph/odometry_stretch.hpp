#pragma once

#include <Eigen/Core>

#include "core/geometry/matrix_rows.hpp"
#include "core/geometry/pose2.hpp"
#include "core/motion/motion.hpp"
#include "core/motion/robot_limits.hpp"

namespace odoless {

/// What laser odometry says of the motion over many scans, and how far it may be off: more than the covariances of its
/// steps say, which hold for independent errors. Along a corridor each step slips the same way, so that slips add up as
/// lengths and not as squares.
///
/// Frames: errors and slip are in the axes of the end (pose_graph.hpp).
struct OdometryStretch {
  Pose2 start_T_end{};
  MatrixRows<3> covariance{};  ///< sum of the steps' own
  Point2 slip_m{};             ///< along unconstrained directions; of either sign
  MatrixRows<2> map_slip{};    ///< sum of the steps' own: Motion::map_slip
  double distance_m = 0.0;
  double rotation_rad = 0.0;
  double unknown_s = 0.0;  ///< over which the motion may be any: after steps that are not credible

  [[nodiscard]] OdometryStretch then(const OdometryStretch& next) const;
  [[nodiscard]] static OdometryStretch of(const Motion& motion);
  /// Of start_T_end as a constraint.
  [[nodiscard]] Eigen::Matrix3d constraint_covariance(const RobotLimits& limits) const;
  /// Whether the robot may have been carried, or turned faster than the scans follow.
  [[nodiscard]] bool is_torn() const { return unknown_s > 0.0; }
};

}  // namespace odoless
