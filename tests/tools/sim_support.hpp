#pragma once

#include <filesystem>
#include <numbers>
#include <string>

#include "core/base/rng.hpp"
#include "tools/sim/world.hpp"

namespace odoless::test {

constexpr double kRadPerDeg = std::numbers::pi / 180.0;

/// One of the example worlds of the source tree.
inline std::filesystem::path example_world(const std::string& name) {
  return std::filesystem::path(__FILE__).parent_path() / "../../tools/worlds" / name;
}

/// The world and its path, seen from a frame in which it stands at `new_T_old`.
inline World transformed(const Pose2& new_T_old, World world) {
  for (Segment& segment : world.segments) {
    segment = {new_T_old * segment.a, new_T_old * segment.b};
  }
  for (Pillar& pillar : world.pillars) {
    pillar.centre = new_T_old * pillar.centre;
  }
  for (Waypoint& waypoint : world.waypoints) {
    waypoint.position = new_T_old * waypoint.position;
  }
  return world;
}

inline Point2 random_point(Rng& rng, double half_side_m) {
  return {rng.uniform(-half_side_m, half_side_m), rng.uniform(-half_side_m, half_side_m)};
}

/// Walls and pillars anywhere in a square of 10 m x 10 m, and a path that heeds none of them.
inline World random_world(Rng& rng) {
  World world;
  for (int i = 0; i < 20; ++i) {
    world.segments.push_back({random_point(rng, 5.0), random_point(rng, 5.0)});
    world.pillars.push_back({random_point(rng, 5.0), rng.uniform(0.05, 0.5)});
  }
  for (int i = 0; i < 8; ++i) {
    world.waypoints.push_back({.position = random_point(rng, 5.0),
                               .speed_mps = rng.uniform(0.1, 2.0),
                               .turn_rate_radps = rng.uniform(0.2, 6.0),
                               .corner_radius_m = i % 3 == 0 ? 0.0 : rng.uniform(0.0, 2.0)});
  }
  return world;
}

}  // namespace odoless::test
