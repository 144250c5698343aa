#include "tools/fault_campaign/drive.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/rng.hpp"
#include "core/geometry/interpolated.hpp"
#include "core/math/elementary.hpp"
#include "tools/sim/ray_caster.hpp"
#include "tools/sim/wanderer.hpp"

namespace odoless::campaign {
namespace {

constexpr double kStep_s = 0.05;
constexpr std::uint64_t kDriveStream = 41;
constexpr std::uint64_t kOtherWayStream = 44;
constexpr double kRest_s = 1.0;  // at the start, as robots do
constexpr double kRamp_s = 2.0;  // until full speed: no robot starts with it

// Time along the world's path, which knows but full speed.
double path_time_s(double true_s) {
  const double driven_s = std::max(0.0, true_s - kRest_s);
  return driven_s < kRamp_s ? 0.5 * driven_s * driven_s / kRamp_s : driven_s - 0.5 * kRamp_s;
}

}  // namespace

Drive::Drive(const Scenario& scenario)
    : world_(load_world(scenario)),
      path_(world_.waypoints),
      path_start_s_(scenario.path_start_s),
      duration_s_(scenario.duration_s),
      mirrored_(scenario.fault.kind == FaultKind::kMirrored) {
  const bool is_carried = scenario.fault.kind == FaultKind::kKidnapping ||
                          (scenario.fault.kind == FaultKind::kSymmetric && scenario.fault.variant == 1);
  if (is_carried) {
    carry_away(scenario);
  }
}

Pose2 Drive::at(double true_s) const {
  if (wandering_.empty() || true_s < carried_s_) {
    return path_.at(path_start_s_ + path_time_s(true_s));
  }
  const double steps = std::min((true_s - carried_s_) / kStep_s, static_cast<double>(wandering_.size() - 1));
  const auto before = static_cast<std::size_t>(steps);
  const std::size_t after = std::min(before + 1, wandering_.size() - 1);
  return interpolated(wandering_[before], wandering_[after], steps - static_cast<double>(before));
}

Pose2 Drive::start_T_robot(double true_s) const {
  const Pose2 pose = path_.at(path_start_s_).inverse() * at(true_s);
  return mirrored_ ? Pose2{pose.x_m, -pose.y_m, -pose.yaw_rad} : pose;
}

// Somewhere that the robot has seen, so that its map has it.
void Drive::carry_away(const Scenario& scenario) {
  constexpr int kTries = 1000;
  Rng chance(scenario.seed, kDriveStream);
  Rng other(scenario.seed, kOtherWayStream);  // rather than nowhere
  const Bounds& bounds = spec_of(scenario.fault.kind).severity;
  const Wanderer wanderer(world_);
  carried_s_ = scenario.fault.start_s;
  const Pose2 from = at(carried_s_);
  for (int tries = 0; tries < kTries; ++tries) {
    const double bearing_rad = chance.uniform(-std::numbers::pi, std::numbers::pi);
    const double yaw_rad = chance.uniform(-std::numbers::pi, std::numbers::pi);
    const double way_m = tries < kTries / 2 ? scenario.fault.severity : other.uniform(bounds.min, bounds.max);
    const Pose2 place{from.x_m + way_m * math::cos(bearing_rad), from.y_m + way_m * math::sin(bearing_rad), yaw_rad};
    if (!wanderer.can_stand(place) || !was_seen(place, scenario)) {
      continue;
    }
    wandering_.push_back(place);
    for (double time_s = carried_s_; time_s < duration_s_; time_s += kStep_s) {
      wandering_.push_back(wanderer.next(wandering_.back(), kStep_s));
    }
    return;
  }
}

bool Drive::was_seen(const Pose2& place, const Scenario& scenario) const {
  constexpr double kLookEvery_s = 0.5;
  constexpr double kSeenFrom_m = 8.0;
  const SimulatedLrfParams laser = laser_of(scenario);
  for (double time_s = 0.0; time_s < carried_s_; time_s += kLookEvery_s) {
    const Pose2 robot = at(time_s);
    const Point2 seen = robot.inverse() * Point2{place.x_m, place.y_m};
    const double way_m = math::hypot(seen.x_m, seen.y_m);
    const double bearing_rad = math::atan2(seen.y_m, seen.x_m);
    if (way_m > std::min(kSeenFrom_m, laser.range_max_m) || std::abs(bearing_rad) > 0.5 * laser.field_of_view_rad) {
      continue;
    }
    const double angle_rad = robot.yaw_rad + bearing_rad;
    if (cast_ray_m(world_, {robot.x_m, robot.y_m}, {math::cos(angle_rad), math::sin(angle_rad)}) > way_m) {
      return true;
    }
  }
  return false;
}

}  // namespace odoless::campaign
