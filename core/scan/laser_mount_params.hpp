#pragma once

#include <cstdint>
#include <numbers>
#include <vector>

#include "core/base/parameters.hpp"
#include "core/geometry/pose2.hpp"

namespace odoless {

/// How the laser is mounted on the robot, which part of its field of view is used, and when its beams are measured.
///
/// Frames: `laser`, as the device counts its bearings; `scan`, at the same place with the axes of the robot, in which
/// all of SLAM works; `robot`, whose pose is told. Bearings of sectors are those of the scan frame: 0 is the robot's
/// front, positive is left. Both `upside_down` and `mirrored` swap left and right, so that both together swap nothing.
struct LaserMountParams {
  double x_m = 0.0;
  double y_m = 0.0;
  double yaw_rad = 0.0;
  bool upside_down = false;
  bool mirrored = false;
  double angle_min_rad = -std::numbers::pi;
  double angle_max_rad = std::numbers::pi;
  std::vector<AngleSector> ignore{};
  std::int64_t sweep_ns = 0;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.value("x_m", self.x_m, Range{-10.0, 10.0}, "How far the laser is ahead of the robot's own point.");
    visit.value("y_m", self.y_m, Range{-10.0, 10.0}, "How far the laser is to the left of the robot's own point.");
    visit.value("yaw_rad", self.yaw_rad, Range{-std::numbers::pi, std::numbers::pi},
                "Direction of the laser's front on the robot, counter-clockwise from the robot's front.");
    visit.flag("upside_down", self.upside_down,
               "Whether the laser hangs upside down, so that its left is the robot's right.");
    visit.flag("mirrored", self.mirrored,
               "Whether the laser counts its bearings clockwise where counter-clockwise is expected.");
    visit.value("angle_min_rad", self.angle_min_rad, Range{-std::numbers::pi, std::numbers::pi},
                "Beams are used from this bearing on, counter-clockwise from the robot's front.");
    visit.value("angle_max_rad", self.angle_max_rad, Range{-std::numbers::pi, std::numbers::pi},
                "Beams are used to this bearing; one that is less than angle_min_deg lies beyond the robot's back.");
    visit.sectors("ignore", self.ignore,
                  "Sectors in which the laser sees the robot itself, such as masts and cables: bearings from the "
                  "robot's front, counter-clockwise from the first to the second.");
    visit.value(
        "sweep_ns", self.sweep_ns, Range<std::int64_t>{-500'000'000, 500'000'000},
        "How long the laser takes for the beams of one scan, for scans that do not tell it (over LCM, and in logs "
        "of CARMEN, DP-SLAM and MRPT): the motion meanwhile is taken out of them. Below 0 where the last beam is "
        "measured first; 0 where it is unknown, or too short to matter.");
  }

  [[nodiscard]] bool is_flipped() const { return upside_down != mirrored; }
};

/// Where the laser is on its robot, for those who show scans and poses. Trivially copyable.
struct LaserPlace {
  double x_m = 0.0;
  double y_m = 0.0;
  double yaw_rad = 0.0;
  bool is_flipped = false;  ///< left and right are swapped

  [[nodiscard]] static LaserPlace of(const LaserMountParams& params) {
    return {params.x_m, params.y_m, params.yaw_rad, params.is_flipped()};
  }

  /// A bearing of the laser in the scan frame.
  [[nodiscard]] double bearing_rad(double laser_rad) const { return (is_flipped ? -laser_rad : laser_rad) + yaw_rad; }

  [[nodiscard]] bool is_in_middle() const { return x_m == 0.0 && y_m == 0.0; }

  /// map_T_robot of map_T_scan; the very same where the laser is in the robot's middle.
  [[nodiscard]] Pose2 robot_of(const Pose2& map_T_scan) const {
    return is_in_middle() ? map_T_scan : map_T_scan * Pose2{-x_m, -y_m, 0.0};
  }
  /// map_T_scan of map_T_robot.
  [[nodiscard]] Pose2 scan_of(const Pose2& map_T_robot) const {
    return is_in_middle() ? map_T_robot : map_T_robot * Pose2{x_m, y_m, 0.0};
  }
};

}  // namespace odoless
