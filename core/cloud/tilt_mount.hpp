#pragma once

#include "core/base/parameters.hpp"
#include "core/geometry/pose2.hpp"
#include "core/geometry/pose3.hpp"

namespace odoless {

/// Where one part is mounted on another.
struct MountParams {
  double x_m = 0.0;
  double y_m = 0.0;
  double z_m = 0.0;
  double roll_rad = 0.0;
  double pitch_rad = 0.0;
  double yaw_rad = 0.0;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    constexpr Range kPlace{-10.0, 10.0};
    constexpr Range kTurn{-3.1416, 3.1416};
    visit.value("x_m", self.x_m, kPlace, "Position along x, forward.");
    visit.value("y_m", self.y_m, kPlace, "Position along y, to the left.");
    visit.value("z_m", self.z_m, kPlace, "Position along z, up.");
    visit.value("roll_rad", self.roll_rad, kTurn, "Rotation about x, applied first.");
    visit.value("pitch_rad", self.pitch_rad, kTurn, "Rotation about y, applied second; positive looks down.");
    visit.value("yaw_rad", self.yaw_rad, kTurn, "Rotation about z, applied last.");
  }

  [[nodiscard]] Pose3 pose() const { return Pose3::of({x_m, y_m, z_m}, roll_rad, pitch_rad, yaw_rad); }
};

/// The laser on its tilt axis on the robot: the extrinsic calibration. Defaults: an axis 0.6 m above the ground and the
/// laser in it.
struct TiltMountParams {
  MountParams robot_T_tilt{.z_m = 0.6};
  MountParams tilt_T_laser{};

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.group("robot_T_tilt", self.robot_T_tilt,
                "The tilt axis (its y axis) at the level pose, seen from the robot's middle on the ground.");
    visit.group("tilt_T_laser", self.tilt_T_laser, "The laser's mirror, seen from the tilt axis.");
  }
};

/// Where the laser is at each angle of its tilt axis.
///
/// Frames: `robot` on the ground, x forward; `tilt` turns about its y by the tilt angle, positive is down; `laser` as a
///         scan's beams count; `scan` is the level laser's frame in the plane, in which 2D SLAM has its poses.
class TiltMount {
 public:
  explicit TiltMount(const TiltMountParams& params);

  [[nodiscard]] Pose3 robot_T_laser(double tilt_rad) const;
  /// The level laser as the plane sees it.
  [[nodiscard]] const Pose2& robot_T_scan() const { return robot_T_scan_; }
  [[nodiscard]] double level_height_m() const { return level_height_m_; }
  [[nodiscard]] const Pose3& robot_T_tilt() const { return robot_T_tilt_; }
  [[nodiscard]] const Pose3& tilt_T_laser() const { return tilt_T_laser_; }

 private:
  Pose3 robot_T_tilt_;
  Pose3 tilt_T_laser_;
  Pose2 robot_T_scan_;
  double level_height_m_ = 0.0;
};

}  // namespace odoless
