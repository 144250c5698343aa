#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "core/graph/keyframe_gate.hpp"
#include "core/graph/submap_graph.hpp"
#include "tests/support/simulated_scene.hpp"

namespace odoless {

/// A ring of corridors, 3 m wide, around a block of `width_m` x `depth_m`, with pillars and niches that differ.
inline SimulatedScene ring(double width_m, double depth_m, std::uint64_t seed = 5) {
  SimulatedScene scene;
  scene.add_box({}, width_m, depth_m);
  scene.add_box({}, width_m + 6.0, depth_m + 6.0);
  Rng rng(seed);
  for (int i = 0; i < 36; ++i) {
    const double side_m = rng.uniform(0.2, 0.7);
    const double along = rng.uniform(-0.5, 0.5);
    const double out_m = rng.below(2) == 0 ? 0.2 : 2.8;
    const double x_m = i % 4 < 2 ? along * (width_m + 5.0) : (i % 4 == 2 ? 1 : -1) * (0.5 * width_m + out_m);
    const double y_m = i % 4 < 2 ? (i % 4 == 0 ? 1 : -1) * (0.5 * depth_m + out_m) : along * (depth_m + 5.0);
    scene.add_box({x_m, y_m, rng.uniform(0.0, 1.5)}, side_m, 0.5 * side_m);
  }
  return scene;
}

/// A corridor of 60 m with a door niche every 4.6 m on both sides, alike.
inline SimulatedScene hotel() {
  SimulatedScene scene;
  for (const double sign : {-1.0, 1.0}) {
    for (int i = 0; i < 13; ++i) {
      const double x_m = 4.6 * i;
      const double wall_m = sign;
      const double back_m = 1.4 * sign;
      scene.walls.push_back({{x_m, wall_m}, {x_m + 3.6, wall_m}});
      scene.walls.push_back({{x_m + 3.6, wall_m}, {x_m + 3.6, back_m}});
      scene.walls.push_back({{x_m + 3.6, back_m}, {x_m + 4.6, back_m}});
      scene.walls.push_back({{x_m + 4.6, back_m}, {x_m + 4.6, wall_m}});
    }
  }
  return scene;
}

/// What stands between the scans and the graph.
class Feed {
 public:
  explicit Feed(const GraphParams& params) : gate_(params) {}
  void add(const ScanFrame& scan, const Motion& motion, SubmapGraph& graph) {
    if (!gate_.add(motion, std::exchange(unknown_s, 0.0))) {
      return;
    }
    Keyframe keyframe;
    std::vector<BeamCode> codes(static_cast<std::size_t>(gate_.beams(scan)));
    gate_.encode(scan, local_T_odom, keyframe, codes);
    gate_.accept();
    bool is_at_work = graph.add(keyframe, codes);
    for (int step = 0; is_at_work && step < steps_max; ++step) {
      const Pose2 before = graph.map_T_odom() * motion.odom_T_current;
      const int thinnings = graph.thinnings();
      is_at_work = graph.work();
      const Pose2 after = graph.map_T_odom() * motion.odom_T_current;
      moved_by_thinning_m = graph.thinnings() == thinnings ? moved_by_thinning_m
                                                           : std::max(moved_by_thinning_m, before.distance_m(after));
      if (const auto said = graph.take_correction()) {
        corrections.push_back({*said, before, after});
      }
    }
  }

  int steps_max = std::numeric_limits<int>::max();  ///< of the graph's work from keyframe to keyframe
  Pose2 local_T_odom{};                             ///< as a particle filter would have it
  double unknown_s = 0.0;                           ///< with the next motion, as it would say
  double moved_by_thinning_m = 0.0;                 ///< the robot, at most

  struct Correction {
    MapCorrection said;
    Pose2 before;  ///< where the graph had the robot
    Pose2 after;
  };
  std::vector<Correction> corrections;

 private:
  KeyframeGate gate_;
};

/// A robot that follows corners, and an odometry that errs the same way all the time.
class Drive {
 public:
  explicit Drive(SimulatedScene scene, const Pose2& drift_per_m, const GraphParams& params = {})
      : graph(params, RobotLimits{}, ScanParams{}, 1), scene_(std::move(scene)), drift_per_m_(drift_per_m) {}

  void drive(const std::vector<Point2>& corners) {
    constexpr double kStep_m = 0.25;
    constexpr double kTurn_rad = 0.2;
    for (std::size_t i = 1; i < corners.size(); ++i) {
      const double dx = corners[i].x_m - corners[i - 1].x_m;
      const double dy = corners[i].y_m - corners[i - 1].y_m;
      const double heading_rad = std::atan2(dy, dx);
      if (poses.empty()) {
        see({corners[0].x_m, corners[0].y_m, heading_rad});
      }
      while (std::abs(wrap_angle(heading_rad - poses.back().yaw_rad)) > 1e-9) {
        const double turn_rad = std::clamp(wrap_angle(heading_rad - poses.back().yaw_rad), -kTurn_rad, kTurn_rad);
        see({poses.back().x_m, poses.back().y_m, wrap_angle(poses.back().yaw_rad + turn_rad)});
      }
      const int steps = static_cast<int>(std::ceil(std::hypot(dx, dy) / kStep_m));
      for (int k = 1; k <= steps; ++k) {
        see({corners[i - 1].x_m + dx * k / steps, corners[i - 1].y_m + dy * k / steps, heading_rad});
      }
    }
  }

  /// Carries the robot elsewhere, which the odometry does not notice; the filter has found it there.
  void carry(const Pose2& world_T_scan, double lost_s) {
    poses.back() = world_T_scan;
    filter = Pose2{};
    feed.unknown_s = lost_s;
  }

  /// Largest distance of a corrected pose from the truth.
  [[nodiscard]] double worst_error_m(const std::vector<StampedPose>& corrected) const {
    double worst_m = 0.0;
    for (std::size_t i = 0; i < corrected.size(); ++i) {
      worst_m = std::max(worst_m, corrected[i].map_T_scan.distance_m(poses.front().inverse() * poses[i]));
    }
    return worst_m;
  }

  SubmapGraph graph;
  Feed feed{GraphParams{}};
  std::vector<Pose2> poses;         ///< true
  std::vector<StampedPose> odom;    ///< odom_T_scan
  double yaw_variance_rad2 = 1e-5;  ///< of a motion, as the odometry claims
  double map_slip_m2 = 0.0;         ///< along the robot's heading, with the next motion
  std::optional<Pose2> filter;      ///< the particle filter is off by this; none: it has what the odometry has

  /// Elsewhere from one scan to the next, which the odometry knows nothing of.
  void carry(const Pose2& world_T_scan) {
    was_carried_ = true;
    see(world_T_scan);
  }

 private:
  void see(const Pose2& world_T_scan) {
    constexpr std::int64_t kPeriod_ns = 200'000'000;
    const auto stamp_ns = static_cast<std::int64_t>(poses.size()) * kPeriod_ns;
    Motion motion;
    if (!poses.empty()) {
      const Pose2 way = was_carried_ ? Pose2{} : poses.back().inverse() * world_T_scan;
      const double length_m = way.distance_m({});
      const Pose2 drifted = way * Pose2{length_m * drift_per_m_.x_m, 0.0, length_m * drift_per_m_.yaw_rad};
      motion = Motion::between(stamp_ns - kPeriod_ns, stamp_ns, drifted);
      motion.set_error(ErrorProcess::independent(drifted, Eigen::Vector3d(1e-4, 1e-4, yaw_variance_rad2).asDiagonal()));
      motion.set_map_slip(Eigen::Vector2d(std::exchange(map_slip_m2, 0.0), 0.0).asDiagonal());
      motion.probability = std::exchange(was_carried_, false) ? 0.0 : motion.probability;
      motion.odom_T_current = odom.back().map_T_scan * drifted;
    }
    poses.push_back(world_T_scan);
    odom.push_back({stamp_ns, motion.odom_T_current});
    if (filter) {
      feed.local_T_odom = *filter * poses.front().inverse() * world_T_scan * motion.odom_T_current.inverse();
    }
    const ScanFrame scan =
        sweep(scene_, {.beams = 181, .angle_step_rad = 1.5 * std::numbers::pi / 180}, world_T_scan, rng_, stamp_ns);
    feed.add(scan, motion, graph);
  }

  SimulatedScene scene_;
  Pose2 drift_per_m_;
  bool was_carried_ = false;
  Rng rng_{1};
};

inline const std::vector<Point2> kRound{{-10.5, -6.5}, {10.5, -6.5}, {10.5, 6.5}, {-10.5, 6.5}, {-10.5, -6.5}};

}  // namespace odoless
