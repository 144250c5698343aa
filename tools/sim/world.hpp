#pragma once

#include <optional>
#include <vector>

#include "core/geometry/pose2.hpp"
#include "tools/sim/building.hpp"
#include "tools/sim/world_parts.hpp"

namespace odoless {

/// A round body that walks to and fro along its way points, at the first one at time 0; world frame.
struct Walker {
  double radius_m = 0.0;
  double speed_mps = 0.0;
  std::vector<Point2> waypoints{};
};

/// A point that the robot's path runs through, and how the robot moves to it.
struct Waypoint {
  Point2 position;  ///< world frame
  double speed_mps = 0.5;
  double turn_rate_radps = 0.8;   ///< bound of the turn rate
  double corner_radius_m = 0.25;  ///< of the arc before the leg to this point; 0: turn on the spot
};

/// A world as a level laser sees it and in space, and the path that a robot takes through it.
struct World {
  std::vector<Segment> segments{};
  std::vector<Pillar> pillars{};
  std::vector<Waypoint> waypoints{};
  std::vector<Walker> walkers{};
  Building building{};  ///< the same in space
};

/// The same world, in which the robot drives no faster than that.
[[nodiscard]] World slowed(World world, double speed_max_mps);

/// The four sides of a rectangle; its middle and direction are `world_T_rectangle`.
[[nodiscard]] std::vector<Segment> rectangle(const Pose2& world_T_rectangle, double width_m, double height_m);

/// Where a walker stands at that time.
[[nodiscard]] Pillar at_time(const Walker& walker, double time_s);

/// What is left of `wall` (0 to 2 pieces) without its part that is nearer to `centre` than `radius_m`.
[[nodiscard]] std::vector<Segment> without_disc(const Segment& wall, const Point2& centre, double radius_m);

/// The part that this takes away.
[[nodiscard]] std::optional<Segment> within_disc(const Segment& wall, const Point2& centre, double radius_m);

}  // namespace odoless
