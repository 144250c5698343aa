#include "tools/sim/wanderer.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/math/elementary.hpp"
#include "tools/sim/ray_caster.hpp"

namespace odoless {
namespace {

constexpr double kClearance_m = 0.4;
constexpr double kLookStep_rad = 0.1;

}  // namespace

Pose2 Wanderer::next(const Pose2& world_T_robot, double period_s) const {
  constexpr double kSpeed_mps = 0.5;
  constexpr double kTurn_radps = 0.8;
  constexpr double kLook_rad = 0.6;
  const bool is_clear = room_m(world_T_robot, -kLook_rad, kLook_rad) > kClearance_m + kSpeed_mps * period_s;
  return world_T_robot * (is_clear ? Pose2{kSpeed_mps * period_s, 0.0, 0.0} : Pose2{0.0, 0.0, kTurn_radps * period_s});
}

bool Wanderer::can_stand(const Pose2& world_T_robot) const {
  return is_indoors(world_T_robot) && room_m(world_T_robot, -std::numbers::pi, std::numbers::pi) > kClearance_m;
}

double Wanderer::room_m(const Pose2& world_T_robot, double from_rad, double to_rad) const {
  double room_m = std::numeric_limits<double>::infinity();
  for (double bearing_rad = from_rad; bearing_rad < to_rad; bearing_rad += kLookStep_rad) {
    const double angle_rad = world_T_robot.yaw_rad + bearing_rad;
    room_m = std::min(room_m, cast_ray_m(world_, {world_T_robot.x_m, world_T_robot.y_m},
                                         {math::cos(angle_rad), math::sin(angle_rad)}));
  }
  return room_m;
}

// A place beyond the walls sees no surface in some direction.
bool Wanderer::is_indoors(const Pose2& world_T_robot) const {
  for (double angle_rad = -std::numbers::pi; angle_rad < std::numbers::pi; angle_rad += kLookStep_rad) {
    const Point2 direction{math::cos(angle_rad), math::sin(angle_rad)};
    if (std::isinf(cast_ray_m(world_, {world_T_robot.x_m, world_T_robot.y_m}, direction))) {
      return false;
    }
  }
  return true;
}

}  // namespace odoless
