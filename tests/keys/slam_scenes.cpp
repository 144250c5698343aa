#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "core/base/rng.hpp"
#include "firmware/stages/stage_chain.hpp"
#include "tests/keys/key_class.hpp"
#include "tools/command/error.hpp"
#include "tools/output/g2o.hpp"
#include "tools/output/matches.hpp"
#include "tools/output/trajectory.hpp"
#include "tools/replay/replay.hpp"
#include "tools/sim/path.hpp"
#include "tools/sim/ray_caster.hpp"
#include "tools/sim/world_file.hpp"

namespace odoless::test {
namespace {

/// Small numbers for speed; what counts little at first is switched on.
constexpr const char* kFast = R"(
[scan]
beams_max = 128
range_max_m = 8.0
[matcher]
points_max = 512
[matcher.search]
start_points = 60
coarse_evaluations = 120
fine_evaluations = 120
simplex_steps = 20
de.population = 16
[matcher.retry]
start_points = 60
coarse_evaluations = 120
fine_evaluations = 120
simplex_steps = 20
de.population = 16
[odometry]
key_scans = 4
local_map.free_penalty = 0.2
[slam.low]
particles = 12
beams_used = 30
refine_steps = 2
weigh_no_return = true
free_no_return_m = 2.0
[slam.low.grid]
width_m = 24.0
height_m = 24.0
tiles_max = 400
[graph]
enabled = false
)";

constexpr const char* kHigh = R"(
[slam.high]
particles = 8
segment_updates = 4
scans_weighed = 2
beams_used = 20
free_no_return_m = 2.0
[slam.high.grid]
width_m = 24.0
height_m = 24.0
tiles_max = 400
)";

/// Scans of a laser in a world, noise and all.
class Recording {
 public:
  explicit Recording(const std::string& world) : world_(parse_world(world, "keys")), path_(world_.waypoints) {
    log_.has_stamps = true;
  }

  /// Goes on along the path for so long.
  Recording& drive(double duration_s, double period_s) {
    for (int i = 0; i < std::lround(duration_s / period_s); ++i) {
      way_s_ += period_s;
      stamp_s_ += period_s;
      sweep(path_.at(way_s_) * aside_);
    }
    return *this;
  }
  /// No scan comes.
  Recording& miss(double duration_s) {
    way_s_ += duration_s;
    stamp_s_ += duration_s;
    return *this;
  }
  /// The robot is carried so far in no time, and drives on from there.
  Recording& carry(const Pose2& robot_T_robot) {
    aside_ = aside_ * robot_T_robot;
    return *this;
  }
  [[nodiscard]] const ScanLog& log() const { return log_; }

 private:
  void sweep(const Pose2& world_T_robot) {
    constexpr int kBeams = 91;
    constexpr double kField_rad = 1.5 * std::numbers::pi;
    LogScan scan;
    scan.stamp_ns = std::llround(stamp_s_ * 1e9);
    scan.start_angle_rad = -0.5 * kField_rad;
    scan.angle_step_rad = kField_rad / (kBeams - 1);
    for (int i = 0; i < kBeams; ++i) {
      const double angle_rad = world_T_robot.yaw_rad + scan.start_angle_rad + i * scan.angle_step_rad;
      const double true_m =
          cast_ray_m(world_, {world_T_robot.x_m, world_T_robot.y_m}, {std::cos(angle_rad), std::sin(angle_rad)});
      scan.ranges_m.push_back(static_cast<float>(true_m + 0.01 * chance_.normal()));
    }
    log_.scans.push_back(std::move(scan));
  }

  World world_;
  Path path_;
  Rng chance_{1};
  Pose2 aside_{};
  double way_s_ = 0.0;
  double stamp_s_ = 0.0;
  ScanLog log_;
};

std::string text_of(const std::vector<StampedPose>& poses) {
  std::string text;
  for (const StampedPose& pose : poses) {
    text +=
        fmt::format("{} {} {} {}\n", pose.stamp_ns, pose.map_T_scan.x_m, pose.map_T_scan.y_m, pose.map_T_scan.yaw_rad);
  }
  return text;
}

std::string text_of(std::vector<MatchRow> rows) {
  for (MatchRow& row : rows) {
    row.time_us = 0.0;
  }
  return format_matches(rows);
}

/// What comes of a log, or how it is refused.
std::string replayed(const ScanLog& log, const DaemonParams& params) {
  try {
    const ReplayResult result = replay(log, params.robot, {}, [](auto, auto, auto) {});
    std::string map(result.map.occupancy_percent.begin(), result.map.occupancy_percent.end());
    const LaserPlace laser = LaserPlace::of(params.robot.mount);
    return text_of(robot_trajectory(result.trajectory, laser)) +
           text_of(robot_trajectory(result.online_trajectory, laser)) + text_of(result.matches) +
           fmt::format("{} {} {} {} {} {}\n", result.lost_scans, result.doubtful_scans, result.relocalisations,
                       result.outside_scans, result.map.width_cells, result.map.height_cells) +
           (result.graph ? format_g2o(*result.graph) : "") + map;
  } catch (const UserError& refusal) {
    return refusal.what();
  }
}

Scene replay_of(const std::string& name, const Recording& recording, std::vector<std::string> tomls) {
  return {name, std::move(tomls),
          [log = recording.log()](const DaemonParams& params) { return replayed(log, params); }};
}

Scene pairs_of(const std::string& name, const Recording& recording, std::vector<std::string> tomls) {
  return {name, std::move(tomls), [log = recording.log()](const DaemonParams& params) {
            return text_of(match_pairs(log, params.robot, {}, [](auto, auto, auto) {}));
          }};
}

constexpr const char* kRoom =
    "room 0 0  12 7\nwall 5 0  5 4\ndoor 5 2  1\nbox 8 5  1 0.6  20\npillar 2.4 3.9  0.2\nbox 1 1  0.6 0.9\n"
    "speed 1\nturn_rate 80\ncorner_radius 0.4\ngo 2 5.4  2.0 2.2  3.2 1.9  9 2  10 5.6  8.5 6.5  3.4 6  3.2 1.9\n";
constexpr const char* kRectangle =
    "room 0 0  7 5\nspeed 1\nturn_rate 80\ncorner_radius 0.4\ngo 1.5 1.5  5 1.5  5 3.5  1.5 3.5  1.5 1.5  5 3\n";

/// What the state is, and the probability of the pose, as the health message has them.
std::string judged(const ScanLog& log, const DaemonParams& params) {
  StageChain chain(params.robot, 1, false);
  std::string text;
  for (const LogScan& scan : log.scans) {
    const ChainStep step = chain.process(scan.raw(), scan.stamp_ns);
    text += fmt::format("{} {}\n", static_cast<int>(step.filter.tracking), step.filter.probability) +
            text_of({{step.stamp_ns, step.filter.map_T_scan}});
  }
  return text;
}

Scene state_of(const std::string& name, const Recording& recording, std::vector<std::string> tomls) {
  return {name, std::move(tomls), [log = recording.log()](const DaemonParams& params) { return judged(log, params); }};
}

std::vector<Scene> tracking_scenes() {
  const Recording jolted =
      std::move(Recording(kRoom).drive(3.0, 0.2).carry({0.3, 0.2, 2.0}).drive(2.0, 0.2).miss(1.2).drive(2.0, 0.2));
  const std::string few = "slam.low.particles_min = 4\nslam.low.spread_error = 0.5\nslam.low.beams_mapped = 60\n";
  return {replay_of("drive", Recording(kRoom).drive(6.0, 0.2), {kFast, few}), replay_of("jolted", jolted, {kFast}),
          replay_of("often poor", jolted, {kFast, "odometry.poor_share = 0.9"}), pairs_of("pairs", jolted, {kFast})};
}

std::vector<Scene> high_scenes() { return {replay_of("segments", Recording(kRoom).drive(6.0, 0.2), {kFast, kHigh})}; }

std::vector<Scene> graph_scenes() {
  const std::string often = "[graph]\nenabled = true\nsubmap_travel_m = 3.0\nsubmap_keyframes = 8\n";
  return {replay_of("loop", Recording(kRectangle).drive(28.0, 0.2), {kFast, often})};
}

std::vector<Scene> recovery_scenes() {
  const std::string soon = "recovery.search = { found_after_s = 1.0, found_fit = 0.3, global.step_deg = 12 }";
  const std::string roughly =
      "recovery.search = { evaluations_per_s = 100000, found_after_s = 1.0, resume_after_s = 4.0,"
      " global = { step_m = 0.5, step_deg = 20, peaks = 20 } }";
  const Recording carried = std::move(Recording(kRoom).drive(14.0, 0.2).carry({1.5, 1.0, 2.5}).drive(6.0, 0.2));
  const Recording carried_early = std::move(Recording(kRoom).drive(9.0, 0.2).carry({1.5, 1.0, 2.5}).drive(6.0, 0.2));
  const Recording rectangle = std::move(Recording(kRectangle).drive(8.0, 0.2).carry({1.0, 0.5, 2.5}).drive(11.0, 0.2));
  return {state_of("carried", carried, {kFast, soon}), state_of("rectangle", rectangle, {kFast, roughly}),
          state_of("sought roughly", carried_early, {kFast, roughly, "recovery.search.found_fit = 0.3"})};
}

}  // namespace

std::vector<KeyClass> slam_classes() {
  return {{"slam", {"robot.", "lrf.mount.", "scan.", "matcher.", "odometry.", "gate.", "slam.low."}, tracking_scenes},
          {"high_level", {"slam.high."}, high_scenes},
          {"graph", {"graph."}, graph_scenes},
          {"recovery", {"recovery."}, recovery_scenes}};
}

}  // namespace odoless::test
