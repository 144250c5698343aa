// The pose graph beside the pipeline: poses and tiles of the world, at the same scans however fast the machine is.
#include "firmware/publisher/graph_feed.hpp"

#include <gtest/gtest.h>

#include <set>
#include <thread>
#include <utility>

#include "core/graph/keyframe_gate.hpp"
#include "tests/support/simulated_room.hpp"

namespace odoless {
namespace {

/// A robot in a room whose keyframes go to the graph; the filter's own map is displaced in the world.
class GraphFeedRun : public ::testing::Test {
 protected:
  explicit GraphFeedRun(const RobotParams& params = {}) : feed_(params, 1, true) {}

  void SetUp() override { ASSERT_EQ(feed_.start(), 0); }

  PoseRecord drive(int scans) {
    PoseRecord pose;
    for (int i = 0; i < scans; ++i) {
      room_.step();
      motion_ = room_.motion();
      motion_.odom_T_current = room_.map_T_scan();
      if (gate_.add(motion_)) {
        Keyframe keyframe;
        std::vector<BeamCode> codes(static_cast<std::size_t>(gate_.beams(room_.scan())));
        gate_.encode(room_.scan(), map_T_odom_, keyframe, codes);
        gate_.accept();
        feed_.add(keyframe, codes);
      }
      pose = {.map_T_scan = map_T_odom_ * motion_.odom_T_current,
              .map_T_odom = map_T_odom_,
              .odom_T_scan = motion_.odom_T_current,
              .covariance = {0.04, 0.0, 0.0, 0.0, 0.01, 0.0, 0.0, 0.0, 0.001}};
      feed_.place(pose);
    }
    return pose;
  }

  Pose2 map_T_odom_{};  ///< as the filter has it
  GraphFeed feed_;

 private:
  KeyframeGate gate_{GraphParams{}};
  SimulatedRoom room_{4};
  Motion motion_;
};

TEST_F(GraphFeedRun, TellsTilesOfTheMapAsItGrows) {
  drive(60);
  std::set<std::pair<int, int>> tiles;
  int occupied = 0;
  MapTileRecord tile;
  std::vector<std::uint8_t> cells(std::tuple_size_v<WorldTiles::Occupancy>);
  for (int i = 0; i < 2000 && (occupied < 100 || tiles.size() < 2); ++i) {
    while (feed_.next_tile(tile, cells)) {
      tiles.emplace(tile.column, tile.row);
      for (const std::uint8_t cell : cells) {
        occupied += cell > 65 && cell <= 100 ? 1 : 0;
      }
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  EXPECT_GT(tiles.size(), 1U);
  EXPECT_GE(occupied, 100);
  EXPECT_EQ(tile.size_cells, WorldTiles::kSide_cells);
}

TEST_F(GraphFeedRun, PutsPosesIntoTheWorld) {
  map_T_odom_ = {2.0, 1.0, 0.5};  // where the map was begun
  PoseRecord pose = drive(200);
  ASSERT_GT(feed_.health().submaps, 2);
  EXPECT_LT(pose.map_T_scan.distance_m(map_T_odom_ * pose.odom_T_scan), 0.2);
  EXPECT_LT(feed_.to_local(pose.map_T_scan).distance_m(pose.map_T_scan), 0.2);
  map_T_odom_ = Pose2{0.5, 0.0, 0.1} * map_T_odom_;  // the filter's map slips: the world does not
  pose = drive(30);
  EXPECT_LT(pose.map_T_scan.distance_m(feed_.health().map_T_odom * pose.odom_T_scan), 1e-9);
  PoseRecord certain{.map_T_odom = map_T_odom_, .odom_T_scan = pose.odom_T_scan};  // as the filter has it
  feed_.place(certain);
  const double drift_m2 = certain.covariance[0] + certain.covariance[4];
  EXPECT_GT(drift_m2, 1e-6);
  EXPECT_LT(drift_m2, 0.01);
  EXPECT_NEAR(pose.covariance[0] + pose.covariance[4] - drift_m2, 0.05, 1e-9) << "turned, no more";
  EXPECT_FALSE(feed_.health().has_drifted);
  EXPECT_GT(std::abs(pose.covariance[1]), 1e-6);
  pose.map_number = 1;  // a map that was begun anew, of which no keyframe is here yet
  const Pose2 before = pose.map_T_scan;
  feed_.place(pose);
  EXPECT_EQ(pose.map_T_scan.distance_m(before), 0.0);
}

RobotParams more_certain_than_can_be() {
  RobotParams params;
  params.recovery.tracking.sure_probability = 1.01;
  return params;
}

/// As if any place had drifted too far for OK.
class DriftedGraphFeed : public GraphFeedRun {
 protected:
  DriftedGraphFeed() : GraphFeedRun(more_certain_than_can_be()) {}
};

TEST_F(DriftedGraphFeed, AMapBegunAnewHasNotDrifted) {
  PoseRecord pose = drive(200);
  EXPECT_TRUE(feed_.health().has_drifted);
  pose.map_number = 1;
  pose.map_T_odom = {3.0, 0.0, 0.0};
  feed_.place(pose);
  EXPECT_FALSE(feed_.health().has_drifted);
  EXPECT_EQ(feed_.health().undrifted, 1.0);
  EXPECT_EQ(feed_.health().map_T_odom.x_m, 3.0);
}

TEST_F(GraphFeedRun, TellsOfEachLoopClosureThatCorrectsThePose) {
  std::int64_t loop_closures = 0;
  std::int64_t last_ns = 0;
  for (int i = 0; i < 60; ++i) {
    drive(10);
    while (const auto correction = feed_.take_correction()) {
      EXPECT_GT(correction->stamp_ns, last_ns);
      last_ns = correction->stamp_ns;
      loop_closures += correction->loop_closures;
    }
  }
  EXPECT_GT(loop_closures, 0);
  EXPECT_EQ(loop_closures, feed_.health().loop_closures);
}

}  // namespace
}  // namespace odoless
