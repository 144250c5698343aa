#pragma once

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

  /// Doors open walls.
  void add_wall(const Segment& wall) { walls_.push_back(wall); }
  /// Doors don't open furniture.
  void add_furniture(const Segment& side) { furniture_.push_back(side); }
  void add_pillar(const Pillar& pillar) { world_.pillars.push_back(pillar); }
  void add_walker(const Walker& walker) { world_.walkers.push_back(walker); }
  void add_door(const Point2& centre, double width_m) { doors_.push_back({centre, width_m / 2.0, line_}); }
  void add_waypoint(const Point2& position);

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
  int line_ = 0;
  World world_;
  std::vector<Segment> walls_;
  std::vector<Segment> furniture_;
  std::vector<Door> doors_;
  std::vector<int> waypoint_lines_;
  Waypoint motion_;
};

}  // namespace odoless
