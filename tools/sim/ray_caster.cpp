#include "tools/sim/ray_caster.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/math/elementary.hpp"

namespace odoless {
namespace {

constexpr double kMiss = std::numeric_limits<double>::infinity();
/// Share of a segment by which it is taken longer, so that no beam slips through where two segments meet.
constexpr double kSlack = 1e-9;

double cross(const Point2& u, const Point2& v) { return u.x_m * v.y_m - u.y_m * v.x_m; }

Point2 from_to(const Point2& from, const Point2& to) { return {to.x_m - from.x_m, to.y_m - from.y_m}; }

}  // namespace

// Solves origin + ray * direction = a + share * (b - a).
double ray_to_segment(const Segment& segment, const Point2& origin, const Point2& direction) {
  const Point2 side = from_to(segment.a, segment.b);
  const double area = cross(direction, side);
  if (area == 0.0) {
    return kMiss;
  }
  const Point2 start = from_to(origin, segment.a);
  const double ray = cross(start, side) / area;
  const double share = cross(start, direction) / area;
  return ray >= 0.0 && share >= -kSlack && share <= 1.0 + kSlack ? ray : kMiss;
}

double ray_to_pillar(const Pillar& pillar, const Point2& origin, const Point2& direction) {
  const Point2 centre = from_to(origin, pillar.centre);
  const double length2 = direction.x_m * direction.x_m + direction.y_m * direction.y_m;
  const double offset = cross(direction, centre);
  const double half_chord2 = pillar.radius_m * pillar.radius_m * length2 - offset * offset;
  if (half_chord2 < 0.0 || length2 == 0.0) {
    return kMiss;
  }
  const double along = direction.x_m * centre.x_m + direction.y_m * centre.y_m;
  const double half_chord = std::sqrt(half_chord2);
  const double ray = (along >= half_chord ? along - half_chord : along + half_chord) / length2;
  return ray >= 0.0 ? ray : kMiss;
}

Pillar aside(const Pillar& person, const Point2& robot) {
  const double x_m = person.centre.x_m - robot.x_m;
  const double y_m = person.centre.y_m - robot.y_m;
  const double away_m = math::hypot(x_m, y_m);
  if (away_m >= kAside_m) {
    return person;
  }
  const Point2 direction = away_m > 0.0 ? Point2{x_m / away_m, y_m / away_m} : Point2{1.0, 0.0};
  return {{robot.x_m + kAside_m * direction.x_m, robot.y_m + kAside_m * direction.y_m}, person.radius_m};
}

double cast_ray_m(const World& world, const Point2& origin, const Point2& direction) {
  double range_m = kMiss;
  for (const Segment& segment : world.segments) {
    range_m = std::min(range_m, ray_to_segment(segment, origin, direction));
  }
  for (const Pillar& pillar : world.pillars) {
    range_m = std::min(range_m, ray_to_pillar(pillar, origin, direction));
  }
  return range_m;
}

double cast_ray_m(const World& world, double time_s, const Point2& origin, const Point2& direction) {
  double range_m = cast_ray_m(world, origin, direction);
  for (const Walker& walker : world.walkers) {
    range_m = std::min(range_m, ray_to_pillar(aside(at_time(walker, time_s), origin), origin, direction));
  }
  return range_m;
}

}  // namespace odoless
