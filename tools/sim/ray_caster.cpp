#include "tools/sim/ray_caster.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace odoless {
namespace {

constexpr double kMiss = std::numeric_limits<double>::infinity();
/// Share of a segment by which it is taken longer, so that no beam slips through where two segments meet.
constexpr double kSlack = 1e-9;

double cross(const Point2& u, const Point2& v) { return u.x_m * v.y_m - u.y_m * v.x_m; }

Point2 from_to(const Point2& from, const Point2& to) { return {to.x_m - from.x_m, to.y_m - from.y_m}; }

/// Solves origin + range * direction = a + share * (b - a).
double range_to_segment_m(const Segment& segment, const Point2& origin, const Point2& direction) {
  const Point2 side = from_to(segment.a, segment.b);
  const double area = cross(direction, side);
  if (area == 0.0) {
    return kMiss;
  }
  const Point2 start = from_to(origin, segment.a);
  const double range_m = cross(start, side) / area;
  const double share = cross(start, direction) / area;
  return range_m >= 0.0 && share >= -kSlack && share <= 1.0 + kSlack ? range_m : kMiss;
}

double range_to_pillar_m(const Pillar& pillar, const Point2& origin, const Point2& direction) {
  const Point2 centre = from_to(origin, pillar.centre);
  const double offset_m = cross(direction, centre);
  const double half_chord_m2 = pillar.radius_m * pillar.radius_m - offset_m * offset_m;
  if (half_chord_m2 < 0.0) {
    return kMiss;
  }
  const double along_m = direction.x_m * centre.x_m + direction.y_m * centre.y_m;
  const double half_chord_m = std::sqrt(half_chord_m2);
  const double range_m = along_m >= half_chord_m ? along_m - half_chord_m : along_m + half_chord_m;
  return range_m >= 0.0 ? range_m : kMiss;
}

}  // namespace

double cast_ray_m(const World& world, const Point2& origin, const Point2& direction) {
  double range_m = kMiss;
  for (const Segment& segment : world.segments) {
    range_m = std::min(range_m, range_to_segment_m(segment, origin, direction));
  }
  for (const Pillar& pillar : world.pillars) {
    range_m = std::min(range_m, range_to_pillar_m(pillar, origin, direction));
  }
  return range_m;
}

double cast_ray_m(const World& world, double time_s, const Point2& origin, const Point2& direction) {
  double range_m = cast_ray_m(world, origin, direction);
  for (const Walker& walker : world.walkers) {
    range_m = std::min(range_m, range_to_pillar_m(at_time(walker, time_s), origin, direction));
  }
  return range_m;
}

}  // namespace odoless
