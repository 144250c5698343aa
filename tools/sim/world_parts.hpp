#pragma once

#include "core/geometry/pose2.hpp"

namespace odoless {

/// A straight piece of surface, seen from both sides; world frame.
struct Segment {
  Point2 a;
  Point2 b;
};

/// A round pillar; world frame.
struct Pillar {
  Point2 centre;
  double radius_m = 0.0;
};

/// Where a ray from `origin` along `direction`, of any length, meets the segment, as a multiple of `direction`;
/// infinity where it misses or runs along it.
[[nodiscard]] double ray_to_segment(const Segment& segment, const Point2& origin, const Point2& direction);

/// The first place where a ray from outside, or the place where one from inside, meets the pillar; as ray_to_segment.
[[nodiscard]] double ray_to_pillar(const Pillar& pillar, const Point2& origin, const Point2& direction);

}  // namespace odoless
