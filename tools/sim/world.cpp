#include "tools/sim/world.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/math/elementary.hpp"

namespace odoless {
namespace {

Point2 along(const Segment& wall, double share) {
  return {wall.a.x_m + share * (wall.b.x_m - wall.a.x_m), wall.a.y_m + share * (wall.b.y_m - wall.a.y_m)};
}

struct Shares {
  double from;
  double to;
};

/// Where the wall is nearer than `radius_m` to `centre`, beyond its ends too; nothing where it is nowhere.
std::optional<Shares> shares_within(const Segment& wall, const Point2& centre, double radius_m) {
  const double ex_m = wall.b.x_m - wall.a.x_m;
  const double ey_m = wall.b.y_m - wall.a.y_m;
  const double wx_m = centre.x_m - wall.a.x_m;
  const double wy_m = centre.y_m - wall.a.y_m;
  const double length_m = math::hypot(ex_m, ey_m);
  const double offset_m = (ex_m * wy_m - ey_m * wx_m) / length_m;
  if (!(std::abs(offset_m) < radius_m)) {
    return std::nullopt;
  }
  const double middle = (ex_m * wx_m + ey_m * wy_m) / (length_m * length_m);
  const double half = std::sqrt(radius_m * radius_m - offset_m * offset_m) / length_m;
  if (middle + half <= 0.0 || middle - half >= 1.0) {
    return std::nullopt;
  }
  return Shares{middle - half, middle + half};
}

double distance_m(const Point2& a, const Point2& b) { return math::hypot(a.x_m - b.x_m, a.y_m - b.y_m); }

}  // namespace

std::vector<Segment> rectangle(const Pose2& world_T_rectangle, double width_m, double height_m) {
  const double x_m = width_m / 2.0;
  const double y_m = height_m / 2.0;
  std::array<Point2, 4> corners{{{-x_m, -y_m}, {x_m, -y_m}, {x_m, y_m}, {-x_m, y_m}}};
  for (Point2& corner : corners) {
    corner = world_T_rectangle * corner;
  }
  return {{corners[0], corners[1]}, {corners[1], corners[2]}, {corners[2], corners[3]}, {corners[3], corners[0]}};
}

Pillar at_time(const Walker& walker, double time_s) {
  const std::vector<Point2>& points = walker.waypoints;
  double length_m = 0.0;
  for (std::size_t i = 1; i < points.size(); ++i) {
    length_m += distance_m(points[i - 1], points[i]);
  }
  const double way_m = std::fmod(std::max(0.0, time_s) * walker.speed_mps, 2.0 * length_m);
  double left_m = way_m <= length_m ? way_m : 2.0 * length_m - way_m;
  for (std::size_t i = 1; i < points.size(); ++i) {
    const double leg_m = distance_m(points[i - 1], points[i]);
    if (left_m <= leg_m) {
      return {along({points[i - 1], points[i]}, left_m / leg_m), walker.radius_m};
    }
    left_m -= leg_m;
  }
  return {points.back(), walker.radius_m};
}

World slowed(World world, double speed_max_mps) {
  for (Waypoint& waypoint : world.waypoints) {
    waypoint.speed_mps = std::min(waypoint.speed_mps, speed_max_mps);
  }
  return world;
}

std::vector<Segment> without_disc(const Segment& wall, const Point2& centre, double radius_m) {
  const std::optional<Shares> cut = shares_within(wall, centre, radius_m);
  if (!cut) {
    return {wall};
  }
  std::vector<Segment> rest;
  if (cut->from > 0.0) {
    rest.push_back({wall.a, along(wall, cut->from)});
  }
  if (cut->to < 1.0) {
    rest.push_back({along(wall, cut->to), wall.b});
  }
  return rest;
}

std::optional<Segment> within_disc(const Segment& wall, const Point2& centre, double radius_m) {
  const std::optional<Shares> cut = shares_within(wall, centre, radius_m);
  if (!cut) {
    return std::nullopt;
  }
  return Segment{cut->from > 0.0 ? along(wall, cut->from) : wall.a, cut->to < 1.0 ? along(wall, cut->to) : wall.b};
}

}  // namespace odoless
