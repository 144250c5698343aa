#pragma once

#include "tools/sim/world.hpp"

namespace odoless {

/// A robot without a path: straight on where there is room, else it turns on the spot.
class Wanderer {
 public:
  /// @param world  Must outlive the wanderer; its walkers are not seen.
  explicit Wanderer(const World& world) : world_(world) {}

  /// Where a robot is one period later.
  [[nodiscard]] Pose2 next(const Pose2& world_T_robot, double period_s) const;
  /// Whether a robot can stand there: indoors, and clear of every surface.
  [[nodiscard]] bool can_stand(const Pose2& world_T_robot) const;

 private:
  [[nodiscard]] double room_m(const Pose2& world_T_robot, double from_rad, double to_rad) const;
  [[nodiscard]] bool is_indoors(const Pose2& world_T_robot) const;

  const World& world_;
};

}  // namespace odoless
