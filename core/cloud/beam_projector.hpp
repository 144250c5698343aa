#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/cloud/tilt_mount.hpp"
#include "core/scan/scan_frame.hpp"

namespace odoless {

/// How the level laser moved while a scan was taken: target_T_scan at the first beam and at the last. Between them the
/// motion is taken to be even.
struct ScanMotion {
  Pose2 target_T_first{};
  Pose2 target_T_last{};
};

/// The end of a beam in space.
struct BeamPoint {
  float x_m = 0.0F;
  float y_m = 0.0F;
  float z_m = 0.0F;  ///< above the robot's ground
  int beam = 0;
};

/// Puts each beam of a scan where it ended in space: at the tilt angle and at the pose of its own time.
///
/// Thread:    owned by one thread.
/// Real time: no allocation after construction; linear in the beams, with two sines and cosines each.
class BeamProjector {
 public:
  BeamProjector(const TiltMount& mount, int beams_max);

  /// The returns of `scan`, which has not been deskewed, in the target frame with z up; valid until the next call.
  /// @param tilts_rad  One angle per beam; beams whose angle is not finite (unknown) are left out.
  [[nodiscard]] std::span<const BeamPoint> project(const ScanFrame& scan, std::span<const double> tilts_rad,
                                                   const ScanMotion& motion);

  [[nodiscard]] const TiltMount& mount() const { return mount_; }

 private:
  TiltMount mount_;
  Pose2 scan_T_robot_;
  std::vector<BeamPoint> points_;
};

}  // namespace odoless
