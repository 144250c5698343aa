#pragma once

#include <vector>

#include "core/geometry/pose3.hpp"
#include "tools/sim/world_parts.hpp"

namespace odoless {

/// An upright piece of surface, seen from both sides.
struct Panel {
  Segment plan;
  double bottom_m = 0.0;
  double top_m = 0.0;
};

/// An upright round pillar, with neither bottom nor top.
struct Column {
  Pillar plan;
  double bottom_m = 0.0;
  double top_m = 0.0;
};

/// A level rectangle of no thickness.
struct Slab {
  Pose2 world_T_middle;
  double width_m = 0.0;  ///< along its x
  double depth_m = 0.0;
  double z_m = 0.0;
};

/// A world with height: floor at z = 0, a ceiling, and what stands between.
struct Building {
  double ceiling_m = 2.6;
  std::vector<Panel> panels{};
  std::vector<Column> columns{};
  std::vector<Slab> slabs{};
};

/// Distance from `origin` along the unit vector `direction` to the first surface, exact but for rounding; infinity
/// where there is none. A surface seen edge-on is not seen. Linear in the surfaces.
[[nodiscard]] double cast_ray_m(const Building& building, const Point3& origin, const Point3& direction);

/// The same of a beam at an angle in the plane of a laser, counter-clockwise from its front.
[[nodiscard]] double cast_beam_m(const Building& building, const Pose3& world_T_laser, double angle_rad);

/// Distance from a point to the nearest surface. Linear in the surfaces.
[[nodiscard]] double distance_m(const Building& building, const Point3& point);

}  // namespace odoless
