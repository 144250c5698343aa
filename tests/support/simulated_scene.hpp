#pragma once

#include <cstdint>
#include <numbers>
#include <utility>
#include <vector>

#include "core/base/rng.hpp"
#include "core/geometry/pose2.hpp"
#include "core/scan/scan_frame.hpp"

namespace odoless {

/// Straight walls, seen from both sides; map frame.
struct SimulatedScene {
  std::vector<std::pair<Point2, Point2>> walls{};

  /// Adds the four sides of a rectangle of `width_m` x `depth_m` around `map_T_box`.
  void add_box(const Pose2& map_T_box, double width_m, double depth_m);
  /// Distance from `p_map` to the nearest wall.
  [[nodiscard]] double clearance_m(const Point2& p_map) const;
};

/// A room of 9 m x 7 m with an alcove and seven boxes of every size and direction: each place looks different.
[[nodiscard]] SimulatedScene cluttered_room();
/// Many small pillars without a wall: nothing of `cluttered_room` is in it.
[[nodiscard]] SimulatedScene pillar_field();
/// Two walls, 2 m apart and 80 m long, along the x axis.
[[nodiscard]] SimulatedScene corridor();

/// A laser that looks at a scene; without noise if `noise_sd_m` is 0.
struct SimulatedLaser {
  int beams = 361;
  double start_angle_rad = -0.75 * std::numbers::pi;
  double angle_step_rad = 1.5 * std::numbers::pi / 360;
  double noise_sd_m = 0.01;
  double range_max_m = 12.0;
};

/// Ranges from `map_T_scan`; infinity where nothing is within range.
[[nodiscard]] std::vector<float> ranges_m(const SimulatedScene& scene, const SimulatedLaser& laser,
                                          const Pose2& map_T_scan, Rng& rng);

/// The same as a scan.
[[nodiscard]] ScanFrame sweep(const SimulatedScene& scene, const SimulatedLaser& laser, const Pose2& map_T_scan,
                              Rng& rng, std::int64_t stamp_ns = 0);

}  // namespace odoless
