// The pose graph as users see it: a loop that the odometry leaves open closes, places that look alike do not close one,
// and the same run gives the same bytes.
#include "core/graph/submap_graph.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <utility>
#include <vector>

#include "core/graph/keyframe_gate.hpp"
#include "core/graph/world_map.hpp"
#include "core/slam/scan_beams.hpp"
#include "tests/support/simulated_scene.hpp"

namespace odoless {
namespace {

/// A ring of corridors, 3 m wide, around a block of `width_m` x `depth_m`, with pillars and niches that differ.
SimulatedScene ring(double width_m, double depth_m) {
  SimulatedScene scene;
  scene.add_box({}, width_m, depth_m);
  scene.add_box({}, width_m + 6.0, depth_m + 6.0);
  Rng rng(5);
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
SimulatedScene hotel() {
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
    if (!gate_.add(motion)) {
      return;
    }
    Keyframe keyframe;
    std::vector<BeamCode> codes(static_cast<std::size_t>(gate_.beams(scan)));
    gate_.encode(scan, {}, keyframe, codes);
    gate_.accept();
    bool is_at_work = graph.add(keyframe, codes);
    while (is_at_work) {
      is_at_work = graph.work();
    }
  }

 private:
  KeyframeGate gate_;
};

/// A robot that follows corners, and an odometry that errs the same way all the time.
class Drive {
 public:
  explicit Drive(SimulatedScene scene, const Pose2& drift_per_m)
      : scene_(std::move(scene)), drift_per_m_(drift_per_m) {}

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

  /// Largest distance of a corrected pose from the truth.
  [[nodiscard]] double worst_error_m(const std::vector<StampedPose>& corrected) const {
    double worst_m = 0.0;
    for (std::size_t i = 0; i < corrected.size(); ++i) {
      worst_m = std::max(worst_m, corrected[i].map_T_scan.distance_m(poses.front().inverse() * poses[i]));
    }
    return worst_m;
  }

  SubmapGraph graph{GraphParams{}, RobotLimits{}, ScanParams{}, 1};
  std::vector<Pose2> poses;       ///< true
  std::vector<StampedPose> odom;  ///< odom_T_scan

 private:
  void see(const Pose2& world_T_scan) {
    constexpr std::int64_t kPeriod_ns = 200'000'000;
    const auto stamp_ns = static_cast<std::int64_t>(poses.size()) * kPeriod_ns;
    Motion motion;
    if (!poses.empty()) {
      const Pose2 way = poses.back().inverse() * world_T_scan;
      const double length_m = way.distance_m({});
      const Pose2 drifted = way * Pose2{length_m * drift_per_m_.x_m, 0.0, length_m * drift_per_m_.yaw_rad};
      motion = Motion::between(stamp_ns - kPeriod_ns, stamp_ns, drifted);
      motion.set_error(ErrorProcess::independent(drifted, Eigen::Vector3d(1e-4, 1e-4, 1e-5).asDiagonal()));
      motion.odom_T_current = odom.back().map_T_scan * drifted;
    }
    poses.push_back(world_T_scan);
    odom.push_back({stamp_ns, motion.odom_T_current});
    const ScanFrame scan =
        sweep(scene_, {.beams = 181, .angle_step_rad = 1.5 * std::numbers::pi / 180}, world_T_scan, rng_, stamp_ns);
    feed_.add(scan, motion, graph);
  }

  Feed feed_{GraphParams{}};
  SimulatedScene scene_;
  Pose2 drift_per_m_;
  Rng rng_{1};
};

const std::vector<Point2> kRound{{-10.5, -6.5}, {10.5, -6.5}, {10.5, 6.5}, {-10.5, 6.5}, {-10.5, -6.5}};

TEST(SubmapGraph, ClosesALoopThatTheOdometryLeavesOpen) {
  Drive run(ring(18.0, 10.0), {0.01, 0.0, 0.0006});
  run.drive(kRound);
  run.drive(kRound);
  const double odometry_m = run.worst_error_m(run.odom);
  run.graph.finish();
  EXPECT_GT(odometry_m, 0.8);
  EXPECT_GT(run.graph.counts().accepted, 5);
  EXPECT_LT(run.worst_error_m(run.graph.corrected(run.odom)), 0.3);
  // Where poses lack, those of some submaps' origins too, the rest is where it was, but for how far it is corrected.
  std::vector<StampedPose> some;
  std::vector<Pose2> true_poses;
  for (std::size_t i = 0; i < run.odom.size(); ++i) {
    if (i % 3 != 0) {
      some.push_back(run.odom[i]);
      true_poses.push_back(run.poses.front().inverse() * run.poses[i]);
    }
  }
  const std::vector<StampedPose> corrected = run.graph.corrected(some);
  for (std::size_t i = 0; i < some.size(); ++i) {
    ASSERT_LT(corrected[i].map_T_scan.distance_m(true_poses[i]), 0.35) << i;
    if (i > 0) {  // and nothing jumps
      const double step_m = corrected[i].map_T_scan.distance_m(corrected[i - 1].map_T_scan);
      ASSERT_LT(step_m, true_poses[i].distance_m(true_poses[i - 1]) + 0.1) << i;
    }
  }
  // and the newest pose is right at the time: that is what map_T_odom is for
  const Pose2 online = run.graph.map_T_odom() * run.odom.back().map_T_scan;
  EXPECT_LT(online.distance_m(run.poses.front().inverse() * run.poses.back()), 0.3);
}

TEST(SubmapGraph, ClosesNoLoopInAHotelCorridor) {
  for (const double scale : {0.0, 0.02, -0.02}) {
    Drive run(hotel(), {scale, 0.0, 0.0});
    run.drive({{1.0, 0.0}, {58.0, 0.0}, {1.0, 0.0}});
    run.graph.finish();
    for (const Constraint& each : run.graph.graph().constraints()) {
      if (!each.is_loop || each.weight < 0.1) {
        continue;
      }
      const auto truth = [&](int submap) {
        const std::int64_t stamp_ns = run.graph.submaps()[static_cast<std::size_t>(submap)].origin_stamp_ns;
        return run.poses[static_cast<std::size_t>(stamp_ns / 200'000'000)];
      };
      const Pose2 wrong = each.from_T_to.inverse() * (truth(each.from).inverse() * truth(each.to));
      EXPECT_LT(wrong.distance_m({}), 1.5) << "submaps " << each.from << " and " << each.to << ", drift " << scale;
    }
  }
}

TEST(SubmapGraph, TheSameRunGivesTheSameBytes) {
  const auto poses = [] {
    Drive run(ring(18.0, 10.0), {0.01, 0.0, 0.0006});
    run.drive(kRound);
    run.drive({kRound[0], kRound[1]});
    run.graph.finish();
    return run.graph.corrected(run.odom);
  };
  const std::vector<StampedPose> first = poses();
  const std::vector<StampedPose> second = poses();
  ASSERT_EQ(first.size(), second.size());
  EXPECT_EQ(std::memcmp(first.data(), second.data(), first.size() * sizeof(StampedPose)), 0);
}

TEST(SubmapGraph, StopsToGrowWhereItIsFullAndGoesOn) {
  GraphParams params;
  params.submaps_max = 16;
  params.keyframes_max = 64;
  SubmapGraph graph(params, {}, {}, 1);
  Feed feed(params);
  const SimulatedScene scene = ring(18.0, 10.0);
  Rng rng(1);
  Motion motion;
  for (int i = 0; i < 800; ++i) {
    if (i > 0) {
      motion = Motion::between(i, i + 1, {0.25, 0.0, 0.0});
      motion.odom_T_current = Pose2{0.25 * i, 0.0, 0.0};
    }
    feed.add(sweep(scene, {.beams = 61}, {-10.5, -6.5, 0.0}, rng, i), motion, graph);
  }
  graph.finish();
  EXPECT_LE(graph.submaps().size(), 16U);
  EXPECT_LE(graph.keyframes().size(), 64);
}

TEST(WorldMap, HasTheWallsOfTheWorldAtTheirPlaces) {
  Drive run(ring(18.0, 10.0), {0.01, 0.0, 0.0006});
  run.drive(kRound);
  run.drive({kRound[0], kRound[1]});
  run.graph.finish();
  WorldMap world_map({}, 0.05);
  world_map.render(run.graph.world(), {});
  OccupancyMap map;
  world_map.write(map);
  const SimulatedScene scene = ring(18.0, 10.0);
  int occupied = 0;
  int right = 0;
  for (int row = 0; row < map.height_cells; ++row) {
    for (int column = 0; column < map.width_cells; ++column) {
      if (map.at(column, row) < 65) {
        continue;
      }
      const Point2 p_map{map.origin_x_m + (column + 0.5) * map.resolution_m,
                         map.origin_y_m + (row + 0.5) * map.resolution_m};
      ++occupied;
      right += scene.clearance_m(run.poses.front() * p_map) < 0.3 ? 1 : 0;
    }
  }
  EXPECT_GT(occupied, 1500);
  EXPECT_GT(right, 0.97 * occupied);
}

/// Every beam whole, into cells kept one by one.
struct PlainCells {
  std::map<std::pair<int, int>, Cell> cells;
  [[nodiscard]] Cell& at(const GridCell& cell) { return cells[{cell.column(), cell.row()}]; }
};

TEST(WorldMap, HasWhatAllBeamsSayOfEachCell) {
  Drive run(ring(40.0, 20.0), {0.01, 0.0, 0.0006});
  run.drive(kRound);
  run.graph.finish();
  const SubmapWorld world = run.graph.world();
  PlainCells plain;
  ScanFrame frame(ScanParams{});
  for (std::size_t i = 0; i < world.submaps.size(); ++i) {
    for (int k = 0; k < world.submaps[i].keyframes; ++k) {
      const int keyframe = world.submaps[i].first_keyframe + k;
      world.store.load(keyframe, 1, frame);
      const Pose2 map_T_scan = world.graph.pose(static_cast<int>(i)) * world.store.submap_T_scan(keyframe);
      integrate_scan(BeamModel({}, 0.05), BeamCaster(GridGeometry{}, map_T_scan), plain, frame, 0.0);
    }
  }
  WorldMap world_map({}, 0.05);
  world_map.render(world, {});
  OccupancyMap map;
  world_map.write(map);
  const int first_column = static_cast<int>(std::lround(map.origin_x_m / 0.05));
  const int first_row = static_cast<int>(std::lround(map.origin_y_m / 0.05));
  std::size_t known = 0;
  std::size_t off = 0;
  for (int row = 0; row < map.height_cells; ++row) {
    for (int column = 0; column < map.width_cells; ++column) {
      const auto found = plain.cells.find({first_column + column, first_row + row});
      const bool is_known = found != plain.cells.end() && !found->second.is_unknown();
      const int expected = is_known ? found->second.occupancy_percent(0.02F / 0.05F * Cell::kParts) : -1;
      known += is_known ? 1 : 0;
      off += std::abs(expected - map.at(column, row)) > 3 ? 1 : 0;
    }
  }
  EXPECT_GT(map.width_cells, 600) << "more than one piece";
  EXPECT_GT(known, 50'000U);
  EXPECT_LT(off, known / 1000);  // where a beam grazes a corner of a cell, ways are rounded otherwise
  EXPECT_GT(known + 10,
            static_cast<std::size_t>(std::count_if(plain.cells.begin(), plain.cells.end(),
                                                   [](const auto& cell) { return !cell.second.is_unknown(); })));
}

// 40 km by 40 km with cells of 5 cm would be 6 * 10^11 of them.
TEST(WorldMap, OfAVastWorldHasLargerCells) {
  GraphParams params;
  SubmapGraph graph(params, {}, {}, 1);
  Feed feed(params);
  const SimulatedScene scene = ring(18.0, 10.0);
  Rng rng(1);
  for (int i = 0; i < 4; ++i) {
    Motion motion;
    if (i > 0) {
      motion = Motion::between(i, i + 1, {10000.0, 10000.0, 0.0});
      motion.odom_T_current = Pose2{10000.0 * i, 10000.0 * i, 0.0};
    }
    feed.add(sweep(scene, {.beams = 61}, {-10.5, -6.5, 0.0}, rng, i), motion, graph);
  }
  graph.finish();
  WorldMap world_map({}, 0.05);
  world_map.render(graph.world(), {});
  OccupancyMap map;
  world_map.write(map);
  EXPECT_GT(map.resolution_m, 1.0);
  EXPECT_FALSE(map.occupancy_percent.empty());
  EXPECT_LT(map.occupancy_percent.size(), 120'000'000U);
}

TEST(WorldMap, OfNothingHasNoCell) {
  const SubmapGraph graph(GraphParams{}, {}, {}, 1);
  WorldMap world_map({}, 0.05);
  world_map.render(graph.world(), {});
  OccupancyMap map;
  world_map.write(map);
  EXPECT_TRUE(map.occupancy_percent.empty());
}

}  // namespace
}  // namespace odoless
