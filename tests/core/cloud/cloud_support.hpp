#pragma once

#include <numbers>
#include <vector>

#include "core/base/rng.hpp"
#include "core/cloud/beam_projector.hpp"
#include "core/scan/scan_frame.hpp"

namespace odoless::test {

inline TiltMountParams random_mount(Rng& rng) {
  const auto part = [&rng] {
    return MountParams{.x_m = rng.uniform(-0.3, 0.3),
                       .y_m = rng.uniform(-0.3, 0.3),
                       .z_m = rng.uniform(0.0, 1.0),
                       .roll_rad = rng.uniform(-0.2, 0.2),
                       .pitch_rad = rng.uniform(-0.2, 0.2),
                       .yaw_rad = rng.uniform(-1.0, 1.0)};
  };
  return {part(), part()};
}

inline Pose2 random_pose(Rng& rng) { return {rng.uniform(-5.0, 5.0), rng.uniform(-5.0, 5.0), rng.uniform(-3.0, 3.0)}; }

/// Ranges of all kinds over 270 deg: some are no returns, some nothing.
inline std::vector<float> random_ranges_m(Rng& rng, int beams) {
  std::vector<float> ranges_m;
  for (int i = 0; i < beams; ++i) {
    const std::uint32_t kind = rng.below(10);
    ranges_m.push_back(kind == 0 ? 0.0F : static_cast<float>(rng.uniform(0.1, kind == 1 ? 50.0 : 20.0)));
  }
  return ranges_m;
}

inline ScanFrame scan_of(const std::vector<float>& ranges_m) {
  ScanFrame scan(ScanParams{});
  const auto steps = static_cast<double>(ranges_m.size() - 1);
  ODOLESS_CHECK(scan.assign({.stamp_ns = 1'000'000,
                             .start_angle_rad = -0.75 * std::numbers::pi,
                             .angle_step_rad = 1.5 * std::numbers::pi / steps,
                             .ranges_m = ranges_m}) == Errc::kOk);
  return scan;
}

inline std::vector<double> random_tilts_rad(Rng& rng, int beams) {
  std::vector<double> tilts_rad;
  const double first_rad = rng.uniform(-1.0, 1.0);
  const double step_rad = rng.uniform(-0.001, 0.001);
  for (int i = 0; i < beams; ++i) {
    tilts_rad.push_back(first_rad + i * step_rad);
  }
  return tilts_rad;
}

/// Where a beam ends, by the chain of frames alone: the oracle of BeamProjector.
inline Point3 plain_end(const TiltMountParams& mount, const ScanFrame& scan, int beam, double tilt_rad,
                        const Pose2& target_T_scan) {
  const Pose3 robot_T_level_laser = mount.robot_T_tilt.pose() * mount.tilt_T_laser.pose();
  const Pose2 robot_T_scan{robot_T_level_laser.origin_m.x(), robot_T_level_laser.origin_m.y(),
                           std::atan2(robot_T_level_laser.rotation(1, 0), robot_T_level_laser.rotation(0, 0))};
  const Pose3 target_T_robot = Pose3::of(target_T_scan * robot_T_scan.inverse());
  const Pose3 tilt_turn = Pose3::of({}, 0.0, tilt_rad, 0.0);
  const Pose3 target_T_laser = target_T_robot * mount.robot_T_tilt.pose() * tilt_turn * mount.tilt_T_laser.pose();
  const double angle_rad = scan.angle_rad(beam);
  return target_T_laser *
         Point3{scan.range_m(beam) * std::cos(angle_rad), scan.range_m(beam) * std::sin(angle_rad), 0.0};
}

}  // namespace odoless::test
