#include "tools/sim/path.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/check.hpp"
#include "core/math/elementary.hpp"

namespace odoless {
namespace {

/// 90 deg, with room for rounding. The arc of a sharper turn would begin far before its way point.
constexpr double kSharpestArcRad = std::numbers::pi / 2.0 + 1e-6;

struct Leg {
  double length_m;
  double yaw_rad;
};

Leg leg_between(const Point2& from, const Point2& to) {
  const double x_m = to.x_m - from.x_m;
  const double y_m = to.y_m - from.y_m;
  return {math::hypot(x_m, y_m), math::atan2(y_m, x_m)};
}

/// The arc (radius 0: turn on the spot) from one leg into the next.
struct Corner {
  double turn_rad = 0.0;
  double radius_m = 0.0;
  double cut_m = 0.0;  ///< what the arc takes from the end of one leg and from the start of the next
};

Corner corner_between(const Leg& before, const Leg& after, double wanted_radius_m) {
  const double turn_rad = wrap_angle(after.yaw_rad - before.yaw_rad);
  if (turn_rad == 0.0 || std::abs(turn_rad) > kSharpestArcRad) {
    return {.turn_rad = turn_rad};
  }
  const double cut_per_radius = math::tan(std::abs(turn_rad) / 2.0);
  const double cut_m = std::min(wanted_radius_m * cut_per_radius, std::min(before.length_m, after.length_m) / 2.0);
  return {turn_rad, cut_m / cut_per_radius, cut_m};
}

/// start_T_robot after `time_s` with constant speed and turn rate.
Pose2 moved(double speed_mps, double turn_rate_radps, double time_s) {
  const double turn_rad = turn_rate_radps * time_s;
  const double chord_m = speed_mps * time_s * (turn_rad == 0.0 ? 1.0 : math::sin(turn_rad / 2.0) / (turn_rad / 2.0));
  return {chord_m * math::cos(turn_rad / 2.0), chord_m * math::sin(turn_rad / 2.0), turn_rad};
}

}  // namespace

Path::Path(std::span<const Waypoint> waypoints) {
  ODOLESS_CHECK(waypoints.size() >= 2);
  const Point2& start = waypoints[0].position;
  Leg leg = leg_between(start, waypoints[1].position);
  world_T_end_ = {start.x_m, start.y_m, leg.yaw_rad};
  Corner last;
  for (std::size_t i = 1; i < waypoints.size(); ++i) {
    ODOLESS_CHECK(leg.length_m > 0.0);
    const bool is_end = i + 1 == waypoints.size();
    const Waypoint& next = waypoints[is_end ? i : i + 1];
    const Leg next_leg = is_end ? leg : leg_between(waypoints[i].position, next.position);
    const Corner corner = is_end ? Corner{} : corner_between(leg, next_leg, next.corner_radius_m);
    append(waypoints[i].speed_mps, 0.0, (leg.length_m - last.cut_m - corner.cut_m) / waypoints[i].speed_mps);
    const double turn_rate_radps = next.turn_rate_radps * corner.radius_m <= next.speed_mps
                                       ? next.turn_rate_radps
                                       : next.speed_mps / corner.radius_m;
    append(turn_rate_radps * corner.radius_m, std::copysign(turn_rate_radps, corner.turn_rad),
           std::abs(corner.turn_rad) / turn_rate_radps);
    leg = next_leg;
    last = corner;
  }
}

void Path::append(double speed_mps, double turn_rate_radps, double lasts_s) {
  if (lasts_s <= 0.0) {
    return;
  }
  pieces_.push_back({duration_s_, world_T_end_, speed_mps, turn_rate_radps});
  world_T_end_ = world_T_end_ * moved(speed_mps, turn_rate_radps, lasts_s);
  duration_s_ += lasts_s;
  length_m_ += speed_mps * lasts_s;
}

Pose2 Path::at(double time_s) const {
  const double at_s = std::clamp(time_s, 0.0, duration_s_);
  const auto after = std::upper_bound(pieces_.begin() + 1, pieces_.end(), at_s,
                                      [](double t_s, const Piece& piece) { return t_s < piece.start_s; });
  const Piece& piece = *(after - 1);
  return piece.world_T_start * moved(piece.speed_mps, piece.turn_rate_radps, at_s - piece.start_s);
}

}  // namespace odoless
