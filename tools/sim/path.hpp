#pragma once

#include <span>
#include <vector>

#include "tools/sim/world.hpp"

namespace odoless {

/// The motion through way points: straight legs, joined by arcs, or by turns on the spot where the corner's radius is 0
/// or the turn is sharper than 90 deg.
///
/// Each leg keeps its speed. An arc is driven at that of the leg after it, or slower where that would exceed the bound
/// of the turn rate; its radius shrinks where it would take more than half of a leg. The pose is continuous, speed and
/// turn rate keep their bounds, and accelerations are without bound.
class Path {
 public:
  /// @param waypoints  Two or more, no two successive ones at the same place.
  explicit Path(std::span<const Waypoint> waypoints);

  /// world_T_robot at that time; the robot rests before 0 and after the end.
  [[nodiscard]] Pose2 at(double time_s) const;
  [[nodiscard]] double duration_s() const { return duration_s_; }
  [[nodiscard]] double length_m() const { return length_m_; }

 private:
  /// Motion with constant speed and turn rate.
  struct Piece {
    double start_s = 0.0;
    Pose2 world_T_start;
    double speed_mps = 0.0;
    double turn_rate_radps = 0.0;
  };

  void append(double speed_mps, double turn_rate_radps, double lasts_s);

  std::vector<Piece> pieces_;
  Pose2 world_T_end_;
  double duration_s_ = 0.0;
  double length_m_ = 0.0;
};

}  // namespace odoless
