#include "tools/sim/world_builder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "core/math/elementary.hpp"
#include "tools/command/error.hpp"
#include "tools/sim/ray_caster.hpp"

namespace odoless {

void WorldBuilder::add_waypoint(const Point2& position) {
  if (!world_.waypoints.empty()) {
    const Point2& last = world_.waypoints.back().position;
    if (math::hypot(position.x_m - last.x_m, position.y_m - last.y_m) < 1e-3) {
      throw DataError(name_, line_,
                      fmt::format("way point {} {} is where the one before it is", position.x_m, position.y_m),
                      "successive way points at least 1 mm apart");
    }
  }
  world_.waypoints.push_back(motion_);
  world_.waypoints.back().position = position;
  waypoint_lines_.push_back(line_);
}

void WorldBuilder::add_box(const Pose2& world_T_middle, double width_m, double depth_m) {
  for (const Segment& side : rectangle(world_T_middle, width_m, depth_m)) {
    furniture_.push_back(side);
    world_.building.panels.push_back({side, 0.0, heights_.box_m});
  }
  if (heights_.box_m < kCeiling) {
    world_.building.slabs.push_back({world_T_middle, width_m, depth_m, heights_.box_m});
  }
}

void WorldBuilder::add_table(const Pose2& world_T_middle, double width_m, double depth_m) {
  constexpr double kLegRadiusM = 0.03;
  for (const Segment& side : rectangle(world_T_middle, width_m - 2.0 * kLegRadiusM, depth_m - 2.0 * kLegRadiusM)) {
    add_column({side.a, kLegRadiusM}, heights_.table_m);  // each corner begins one side
  }
  world_.building.slabs.push_back({world_T_middle, width_m, depth_m, heights_.table_m});
}

void WorldBuilder::add_column(const Pillar& pillar, double top_m) {
  world_.pillars.push_back(pillar);
  world_.building.columns.push_back({pillar, 0.0, top_m});
}

// No part of a building is higher than its ceiling.
void WorldBuilder::raise_walls() {
  Building& building = world_.building;
  for (const Segment& wall : walls_) {
    building.panels.push_back({wall, 0.0, building.ceiling_m});
  }
  for (Panel& panel : building.panels) {
    panel.top_m = std::min(panel.top_m, building.ceiling_m);
  }
  std::erase_if(building.panels, [](const Panel& panel) { return panel.top_m <= panel.bottom_m; });
  for (Column& column : building.columns) {
    column.top_m = std::min(column.top_m, building.ceiling_m);
  }
}

void WorldBuilder::open(const Door& door) {
  std::vector<Segment> rest;
  bool has_opened = false;
  for (const Segment& wall : walls_) {
    const std::vector<Segment> pieces = without_disc(wall, door.centre, door.radius_m);
    const bool is_untouched = pieces.size() == 1 && pieces[0].a.x_m == wall.a.x_m && pieces[0].a.y_m == wall.a.y_m &&
                              pieces[0].b.x_m == wall.b.x_m && pieces[0].b.y_m == wall.b.y_m;
    has_opened = has_opened || !is_untouched;
    rest.insert(rest.end(), pieces.begin(), pieces.end());
    if (const std::optional<Segment> opening = within_disc(wall, door.centre, door.radius_m)) {
      world_.building.panels.push_back({*opening, door.height_m, kCeiling});  // the lintel
    }
  }
  if (!has_opened) {
    throw DataError(name_, door.line, fmt::format("door {} {} opens no wall", door.centre.x_m, door.centre.y_m),
                    "a door whose middle lies on a wall or a room's side");
  }
  walls_ = std::move(rest);
}

void WorldBuilder::check_path() const {
  if (world_.waypoints.size() < 2) {
    throw DataError(name_, 0, fmt::format("the path has {} way points", world_.waypoints.size()),
                    "`go` with two points or more");
  }
  for (std::size_t i = 1; i < world_.waypoints.size(); ++i) {
    const Point2& from = world_.waypoints[i - 1].position;
    const Point2& to = world_.waypoints[i].position;
    const double length_m = math::hypot(to.x_m - from.x_m, to.y_m - from.y_m);
    const Point2 direction{(to.x_m - from.x_m) / length_m, (to.y_m - from.y_m) / length_m};
    const double free_m = cast_ray_m(world_, from, direction);
    if (free_m <= length_m) {
      throw DataError(name_, waypoint_lines_[i],
                      fmt::format("the path from {} {} to {} {} hits a surface after {:.2f} m", from.x_m, from.y_m,
                                  to.x_m, to.y_m, free_m),
                      "way points joined by free straight lines (a door may be missing)");
    }
  }
}

World WorldBuilder::build() {
  for (const Door& door : doors_) {
    open(door);
  }
  raise_walls();
  world_.segments = walls_;
  world_.segments.insert(world_.segments.end(), furniture_.begin(), furniture_.end());
  check_path();
  return world_;
}

}  // namespace odoless
