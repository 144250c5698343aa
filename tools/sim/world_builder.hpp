#pragma once

#include <string>
#include <vector>

#include "tools/sim/world.hpp"

namespace odoless {

/// Collects what a world file states, line by line, and checks in the end that it makes a world.
///
/// Every function takes the line of the statement, for messages, and throws DataError.
class WorldBuilder {
 public:
  /// `name` is the file's, for messages.
  explicit WorldBuilder(std::string name) : name_(std::move(name)) {}

  /// Doors open walls.
  void add_wall(const Segment& wall) { walls_.push_back(wall); }
  /// Doors don't open furniture.
  void add_furniture(const Segment& side) { furniture_.push_back(side); }
  void add_pillar(const Pillar& pillar) { world_.pillars.push_back(pillar); }
  void add_door(const Point2& centre, double width_m, int line) { doors_.push_back({centre, width_m / 2.0, line}); }
  void add_waypoint(const Point2& position, int line);

  /// How the robot moves to the way points that follow.
  [[nodiscard]] Waypoint& motion() { return motion_; }

  [[nodiscard]] World build();

 private:
  struct Door {
    Point2 centre;
    double radius_m;
    int line;
  };

  void open(const Door& door);
  void check_path() const;

  std::string name_;
  World world_;
  std::vector<Segment> walls_;
  std::vector<Segment> furniture_;
  std::vector<Door> doors_;
  std::vector<int> waypoint_lines_;
  Waypoint motion_;
};

}  // namespace odoless
