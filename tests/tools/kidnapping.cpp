#include "tests/tools/kidnapping.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/check.hpp"
#include "rt/cpu_clock.hpp"
#include "tests/support/allocation_guard.hpp"
#include "tools/fault_campaign/judge.hpp"
#include "tools/sim/ray_caster.hpp"
#include "tools/sim/wanderer.hpp"

namespace odoless::test {
namespace {

constexpr int kBeams = 181;
constexpr double kStep_rad = std::numbers::pi / (kBeams - 1);
constexpr double kNoise_sd_m = 0.015;

/// Time that something holds, at a stretch.
struct Stretch {
  double now_s = 0.0;
  double longest_s = 0.0;
  void add(bool holds) {
    now_s = holds ? now_s + KidnappedRobot::kPeriod_s : 0.0;
    longest_s = std::max(longest_s, now_s);
  }
};

}  // namespace

KidnappedRobot::KidnappedRobot(const World& world, const RobotParams& params, std::uint64_t seed)
    : world_(world),
      path_(world.waypoints),
      matcher_(params, seed),
      filter_(params, seed),
      frame_(params.scan),
      chance_(seed, 17),
      world_T_map_(path_.at(0.0)),
      ranges_m_(kBeams),
      world_T_robot_(world_T_map_) {}

void KidnappedRobot::drive_until(double share) {
  while (static_cast<double>(scans_) * kPeriod_s < share * path_.duration_s()) {
    world_T_robot_ = path_.at(static_cast<double>(scans_) * kPeriod_s);
    static_cast<void>(scan());
  }
}

Kidnapping KidnappedRobot::carry_away(std::uint64_t seed, double watched_s) {
  chance_ = Rng(seed, 18);
  Kidnapping out;
  world_T_map_ = world_T_robot_ * map_T_scan_.inverse();
  if (filter_.tracking() != Tracking::kSure || !choose_place()) {
    return out;
  }
  out.happened = true;
  heap_calls_ = 0;
  Stretch sure;
  Stretch claimed;
  bool found = false;
  for (double time_s = 0.0; time_s < watched_s; time_s += kPeriod_s) {
    const FilterStep step = scan();
    const bool lost = step.tracking == Tracking::kLost;
    const bool wrong = is_wrong(step.map_T_scan);
    out.lost_after_s = lost ? std::min(out.lost_after_s, time_s) : out.lost_after_s;
    out.lost_scans += lost ? 1 : 0;
    out.slice_us_max = lost ? std::max(out.slice_us_max, slice_us_) : out.slice_us_max;
    found = found || step.found;
    sure.add(wrong && step.tracking == Tracking::kSure);
    claimed.add(wrong && !lost && found);
    out.found_after_s = lost || wrong ? std::numeric_limits<double>::infinity() : std::min(out.found_after_s, time_s);
    world_T_robot_ = Wanderer(world_).next(world_T_robot_, kPeriod_s);
  }
  out.heap_calls = heap_calls_;
  out.wrong_sure_s = sure.longest_s;
  out.wrong_claimed_s = claimed.longest_s;
  return out;
}

FilterStep KidnappedRobot::scan() {
  constexpr double kStart_rad = -0.5 * std::numbers::pi;
  for (int i = 0; i < kBeams; ++i) {
    const double angle_rad = world_T_robot_.yaw_rad + kStart_rad + i * kStep_rad;
    const double true_m =
        cast_ray_m(world_, {world_T_robot_.x_m, world_T_robot_.y_m}, {std::cos(angle_rad), std::sin(angle_rad)});
    ranges_m_[static_cast<std::size_t>(i)] = static_cast<float>(true_m + kNoise_sd_m * chance_.normal());
  }
  const auto stamp_ns = static_cast<std::int64_t>(static_cast<double>(scans_++) * kPeriod_s * 1e9);
  const Errc error = frame_.assign(
      {.stamp_ns = stamp_ns, .start_angle_rad = kStart_rad, .angle_step_rad = kStep_rad, .ranges_m = ranges_m_});
  ODOLESS_CHECK(error == Errc::kOk);
  const Motion motion = matcher_.process(frame_);
  const AllocationGuard guard;
  const std::int64_t before_ns = thread_cpu_ns();
  const FilterStep out = filter_.process(frame_, motion);
  slice_us_ = static_cast<double>(thread_cpu_ns() - before_ns) * 1e-3;
  heap_calls_ += guard.calls();
  map_T_scan_ = out.map_T_scan;
  return out;
}

bool KidnappedRobot::choose_place() {
  constexpr double kDistance_m = 3.0;
  OccupancyMap map;
  filter_.filter().write_occupancy(map);
  for (int tries = 0; tries < 100; ++tries) {
    const double bearing_rad = chance_.uniform(-std::numbers::pi, std::numbers::pi);
    const double turn_rad = chance_.below(2) == 0 ? 0.5 * std::numbers::pi : -0.5 * std::numbers::pi;
    const Pose2 place{world_T_robot_.x_m + kDistance_m * std::cos(bearing_rad),
                      world_T_robot_.y_m + kDistance_m * std::sin(bearing_rad),
                      wrap_angle(world_T_robot_.yaw_rad + turn_rad)};
    const Point2 p_map = world_T_map_.inverse() * Point2{place.x_m, place.y_m};
    const int column = static_cast<int>(std::floor((p_map.x_m - map.origin_x_m) / map.resolution_m));
    const int row = static_cast<int>(std::floor((p_map.y_m - map.origin_y_m) / map.resolution_m));
    const bool inside = column >= 0 && row >= 0 && column < map.width_cells && row < map.height_cells;
    const int percent = inside ? map.at(column, row) : OccupancyMap::kUnknown;
    if (percent >= 0 && percent < 20 && Wanderer(world_).can_stand(place)) {
      world_T_robot_ = place;
      return true;
    }
  }
  return false;
}

bool KidnappedRobot::is_wrong(const Pose2& map_T_scan) const {
  return campaign::is_wrong((world_T_map_.inverse() * world_T_robot_).inverse() * map_T_scan);
}

}  // namespace odoless::test
