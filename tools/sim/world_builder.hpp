#pragma once

#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "tools/sim/world.hpp"

namespace odoless {

/// Collects what a world file states, line by line, and checks in the end that it makes a world.
///
/// Functions that can fail throw DataError, with the line of the statement that is wrong.
class WorldBuilder {
 public:
  /// `name` is the file's, for messages.
  explicit WorldBuilder(std::string name) : name_(std::move(name)) {}

  /// The line of the statement that follows.
  void at_line(int line) { line_ = line; }

  /// From the floor to the ceiling. Doors open walls, up to their own height.
  void add_wall(const Segment& wall) { walls_.push_back(wall); }
  /// Doors don't open boxes. From the floor to heights().box_m.
  void add_box(const Pose2& world_T_middle, double width_m, double depth_m);
  /// A top at heights().table_m on four legs, which are all that a level laser sees.
  void add_table(const Pose2& world_T_middle, double width_m, double depth_m);
  /// From the floor to the ceiling.
  void add_pillar(const Pillar& pillar) { add_column(pillar, kCeiling); }
  void add_walker(const Walker& walker) { world_.walkers.push_back(walker); }
  void add_door(const Point2& centre, double width_m) {
    doors_.push_back({centre, width_m / 2.0, heights_.door_m, line_});
  }
  void add_waypoint(const Point2& position);

  /// Stands for the ceiling's height, which may not be known yet.
  static constexpr double kCeiling = std::numeric_limits<double>::infinity();

  /// Of what follows.
  struct Heights {
    double door_m = 2.0;
    double box_m = kCeiling;
    double table_m = 0.75;
  };
  [[nodiscard]] Heights& heights() { return heights_; }
  void set_ceiling(double ceiling_m) { world_.building.ceiling_m = ceiling_m; }

  /// How the robot moves to the way points that follow.
  [[nodiscard]] Waypoint& motion() { return motion_; }

  [[nodiscard]] World build();

 private:
  struct Door {
    Point2 centre;
    double radius_m;
    double height_m;
    int line;
  };

  void add_column(const Pillar& pillar, double top_m);
  void open(const Door& door);
  void raise_walls();
  void check_path() const;

  std::string name_;
  int line_ = 0;
  World world_;
  std::vector<Segment> walls_;
  std::vector<Segment> furniture_;
  std::vector<Door> doors_;
  std::vector<int> waypoint_lines_;
  Waypoint motion_;
  Heights heights_;
};

}  // namespace odoless
