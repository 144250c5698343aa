#include "core/slam/slam.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/core/slam/same_pose.hpp"
#include "tests/support/simulated_room.hpp"

namespace odoless {
namespace {

constexpr ScanParams kSlamScan{.beams_max = 120, .range_max_m = 20.0};

SlamParams small_slam(int high_particles) {
  SlamParams params;
  params.low.particles = 20;
  params.low.grid = {.resolution_m = 0.1, .width_m = 8.0, .height_m = 8.0, .tiles_max = 8000};
  params.high.particles = high_particles;
  params.high.segment_updates = 6;
  params.high.grid = params.low.grid;
  return params;
}

TEST(Slam, IsTheLowLevelAloneWhereTheHighOneIsOff) {
  Slam slam(small_slam(0), kSlamScan, 5);
  Lslam low(small_slam(0).low, 5);
  SimulatedRoom room(4, 120);
  for (int i = 0; i < 30; ++i) {
    room.step();
    static_cast<void>(slam.update(room.motion(), room.scan()));
    static_cast<void>(low.update(room.motion(), room.scan()));
    slam.work();
    ASSERT_TRUE(same_pose(slam.map_T_scan(), low.pose(low.best())));
  }
  slam.finish();
  std::vector<StampedPose> path;
  slam.write_path(path);
  EXPECT_EQ(path.size(), 30U);
  EXPECT_EQ(slam.high(), nullptr);
}

TEST(Slam, WithBothLevelsHasAPosePerUpdateAndStaysOnTrack) {
  Slam slam(small_slam(20), kSlamScan, 5);
  SimulatedRoom room(4, 120);
  std::vector<Pose2> truth;
  for (int i = 0; i < 100; ++i) {
    room.step();
    truth.push_back(room.map_T_scan());
    static_cast<void>(slam.update(room.motion(), room.scan()));
    slam.work();
    ASSERT_LT(slam.map_T_scan().distance_m(room.map_T_scan()), 0.25) << i;
    const PoseEstimate estimate = slam.estimate();
    ASSERT_LT(estimate.map_T_scan.distance_m(slam.map_T_scan()), 0.2) << i;
  }
  EXPECT_GT(slam.high()->report().segments, 14);
  slam.finish();
  std::vector<StampedPose> path;
  slam.write_path(path);
  ASSERT_EQ(path.size(), truth.size());
  for (std::size_t i = 0; i < path.size(); ++i) {
    EXPECT_LT(path[i].map_T_scan.distance_m(truth[i]), 0.25) << i;
  }
  EXPECT_GT(slam.pool_used(), 0.0);
  OccupancyMap map;
  slam.write_occupancy(map);
  EXPECT_FALSE(map.occupancy_percent.empty());
}

// While the robot is lost: what the map was made of is to be in it before it is searched.
TEST(Slam, SettlesOnceTheSegmentThatHasBegunIsInTheHighLevel) {
  Slam low(small_slam(0), kSlamScan, 5);
  EXPECT_TRUE(low.settle()) << "there is only one level";
  Slam slam(small_slam(20), kSlamScan, 5);
  SimulatedRoom room(4, 120);
  for (int i = 0; i < 10; ++i) {  // a segment has 6
    room.step();
    static_cast<void>(slam.update(room.motion(), room.scan()));
    slam.work();
  }
  int calls = 1;
  for (; !slam.settle() && calls < 1000; ++calls) {
  }
  EXPECT_LT(calls, 1000);
  EXPECT_EQ(slam.high()->report().segments, 2) << "the second has 4";
  EXPECT_TRUE(slam.settle());
  EXPECT_EQ(slam.high()->report().segments, 2) << "and there is no more to be done";
  EXPECT_LT(slam.map_T_scan().distance_m(room.map_T_scan()), 0.25);
}

TEST(Slam, SegmentsAreDoneBeforeTheNextEndsIfWorkIsCalledOncePerUpdate) {
  Slam slam(small_slam(20), kSlamScan, 5);
  SimulatedRoom room(4, 120);
  for (int i = 1; i <= 60; ++i) {
    room.step();
    static_cast<void>(slam.update(room.motion(), room.scan()));
    slam.work();
    EXPECT_GE(slam.high()->report().segments, i / 6 - 1) << i;
    EXPECT_TRUE(i % 6 != 5 || slam.high()->idle()) << i;
  }
}

TEST(Slam, IsPutWhereTheUserSays) {
  for (const int high : {0, 10}) {
    Slam slam(small_slam(high), kSlamScan, 5);
    SimulatedRoom room(4, 120);
    for (int i = 0; i < 20; ++i) {
      room.step();
      static_cast<void>(slam.update(room.motion(), room.scan()));
      slam.work();
    }
    const Pose2 put{1.0, 0.5, -2.0};
    slam.set_pose(put);
    EXPECT_LT(slam.map_T_scan().distance_m(put), 1e-9) << high;
    EXPECT_NEAR(wrap_angle(slam.map_T_scan().yaw_rad - put.yaw_rad), 0.0, 1e-9) << high;
    slam.reset({});
    EXPECT_TRUE(same_pose(slam.map_T_scan(), Pose2{})) << high;
  }
}

}  // namespace
}  // namespace odoless
