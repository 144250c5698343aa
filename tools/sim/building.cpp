#include "tools/sim/building.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/math/elementary.hpp"

namespace odoless {
namespace {

constexpr double kMiss = std::numeric_limits<double>::infinity();

struct Ray {
  Point3 origin;
  Point3 direction;

  [[nodiscard]] Point3 at(double range_m) const {
    return {origin.x_m + range_m * direction.x_m, origin.y_m + range_m * direction.y_m,
            origin.z_m + range_m * direction.z_m};
  }
  /// How far to the height; infinity where it is not reached.
  [[nodiscard]] double to_height_m(double z_m) const {
    const double range_m = (z_m - origin.z_m) / direction.z_m;
    return direction.z_m != 0.0 && range_m >= 0.0 ? range_m : kMiss;
  }
};

Point2 plan(const Point3& point) { return {point.x_m, point.y_m}; }

/// Infinity where the height is not between.
double if_between(const Ray& ray, double range_m, double bottom_m, double top_m) {
  if (!std::isfinite(range_m)) {
    return kMiss;
  }
  const double z_m = ray.at(range_m).z_m;
  return z_m >= bottom_m && z_m <= top_m ? range_m : kMiss;
}

bool is_on(const Slab& slab, const Point2& p_slab) {
  return std::abs(p_slab.x_m) <= slab.width_m / 2.0 && std::abs(p_slab.y_m) <= slab.depth_m / 2.0;
}

double range_to_slab_m(const Slab& slab, const Ray& ray) {
  const double range_m = ray.to_height_m(slab.z_m);
  return std::isfinite(range_m) && is_on(slab, slab.world_T_middle.inverse() * plan(ray.at(range_m))) ? range_m : kMiss;
}

/// How far outside of an interval.
double outside_m(double value_m, double low_m, double high_m) {
  return std::max({low_m - value_m, 0.0, value_m - high_m});
}

double distance_to_segment_m(const Segment& segment, const Point2& point) {
  const double side_x_m = segment.b.x_m - segment.a.x_m;
  const double side_y_m = segment.b.y_m - segment.a.y_m;
  const double x_m = point.x_m - segment.a.x_m;
  const double y_m = point.y_m - segment.a.y_m;
  const double share = (x_m * side_x_m + y_m * side_y_m) / (side_x_m * side_x_m + side_y_m * side_y_m);
  const double on_it = std::clamp(share, 0.0, 1.0);
  return math::hypot(x_m - on_it * side_x_m, y_m - on_it * side_y_m);
}

double distance_to_slab_m(const Slab& slab, const Point3& point) {
  const Point2 p_slab = slab.world_T_middle.inverse() * plan(point);
  const double x_m = outside_m(std::abs(p_slab.x_m), 0.0, slab.width_m / 2.0);
  const double y_m = outside_m(std::abs(p_slab.y_m), 0.0, slab.depth_m / 2.0);
  return math::hypot(math::hypot(x_m, y_m), point.z_m - slab.z_m);
}

}  // namespace

double cast_ray_m(const Building& building, const Point3& origin, const Point3& direction) {
  const Ray ray{origin, direction};
  double range_m = std::min(ray.to_height_m(0.0), ray.to_height_m(building.ceiling_m));
  for (const Panel& panel : building.panels) {
    range_m = std::min(range_m, if_between(ray, ray_to_segment(panel.plan, plan(origin), plan(direction)),
                                           panel.bottom_m, panel.top_m));
  }
  for (const Column& column : building.columns) {
    range_m = std::min(range_m, if_between(ray, ray_to_pillar(column.plan, plan(origin), plan(direction)),
                                           column.bottom_m, column.top_m));
  }
  for (const Slab& slab : building.slabs) {
    range_m = std::min(range_m, range_to_slab_m(slab, ray));
  }
  return range_m;
}

double cast_beam_m(const Building& building, const Pose3& world_T_laser, double angle_rad) {
  const Eigen::Vector3d direction =
      world_T_laser.rotation * Eigen::Vector3d(math::cos(angle_rad), math::sin(angle_rad), 0.0);
  const Eigen::Vector3d& origin_m = world_T_laser.origin_m;
  return cast_ray_m(building, {origin_m.x(), origin_m.y(), origin_m.z()},
                    {direction.x(), direction.y(), direction.z()});
}

double distance_m(const Building& building, const Point3& point) {
  double nearest_m = std::min(std::abs(point.z_m), std::abs(point.z_m - building.ceiling_m));
  for (const Panel& panel : building.panels) {
    nearest_m = std::min(nearest_m, math::hypot(distance_to_segment_m(panel.plan, plan(point)),
                                                outside_m(point.z_m, panel.bottom_m, panel.top_m)));
  }
  for (const Column& column : building.columns) {
    const double from_axis_m = math::hypot(point.x_m - column.plan.centre.x_m, point.y_m - column.plan.centre.y_m);
    nearest_m = std::min(nearest_m, math::hypot(from_axis_m - column.plan.radius_m,
                                                outside_m(point.z_m, column.bottom_m, column.top_m)));
  }
  for (const Slab& slab : building.slabs) {
    nearest_m = std::min(nearest_m, distance_to_slab_m(slab, point));
  }
  return nearest_m;
}

}  // namespace odoless
