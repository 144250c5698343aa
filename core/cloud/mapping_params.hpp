#pragma once

#include <cstdint>

#include "core/cloud/keyed_cloud.hpp"
#include "core/cloud/level_scan.hpp"
#include "core/cloud/tilt_mount.hpp"

namespace odoless {

/// In which form a cloud is saved.
enum class CloudFormat : std::uint8_t { kNone, kPly, kPcd };
inline constexpr const char* kCloudFormatNames[] = {"none", "ply", "pcd"};

/// 3D mapping with a tilting laser.
struct MappingParams {
  bool enabled = true;
  CloudFormat save_as = CloudFormat::kPly;
  TiltMountParams mount{};
  LevelParams level{};
  CloudParams cloud{};
  double pose_gap_max_s = 2.0;
  double yaw_doubt_max_rad = 0.008726646259971648;
  double angle_gap_max_s = 0.5;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor& visit) {
    visit.flag("enabled", self.enabled, "Whether the daemon maps in 3D where a tilt servo is configured.");
    visit.choice(
        "save_as", self.save_as, kCloudFormatNames,
        "Form in which the daemon saves the 3D map: cloud.ply or cloud.pcd beside the map; none: it does not.");
    visit.group("mount", self.mount, "The laser on its tilt axis on the robot: the extrinsic calibration.");
    visit.group("level", self.level, "Which scans of a tilting laser serve 2D SLAM.");
    visit.group("cloud", self.cloud, "The cloud of points.");
    visit.value(
        "pose_gap_max_s", self.pose_gap_max_s, Range{0.01, 60.0},
        "Longest time between two poses that are interpolated; scans in longer gaps are left out of the cloud.");
    visit.value("yaw_doubt_max_rad", self.yaw_doubt_max_rad, Range{0.0001, 3.1416},
                "Largest uncertainty of the heading, from uneven turning between two level scans, at which a scan goes "
                "into the cloud.");
    visit.value("angle_gap_max_s", self.angle_gap_max_s, Range{0.001, 60.0},
                "Longest time between two servo angles that are interpolated; beams in longer gaps are left out.");
  }
};

}  // namespace odoless
