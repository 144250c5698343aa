#include "core/graph/trajectory_correction.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <span>
#include <vector>

namespace odoless {
namespace {

constexpr std::int64_t kBegin_ns = 1'000;

/// A metre along x per pose.
std::vector<StampedPose> straight_drive(int metres) {
  std::vector<StampedPose> odom;
  for (int i = 0; i <= metres; ++i) {
    odom.push_back({kBegin_ns + i, Pose2{static_cast<double>(i), 0.0, 0.0}});
  }
  return odom;
}

/// A submap whose origin is the drive's pose at `metres`, and where the graph has it.
SubmapPlace submap_at(int metres, const Pose2& map_T_submap) {
  return {.odom_T_submap = {static_cast<double>(metres), 0.0, 0.0},
          .map_T_submap = map_T_submap,
          .origin_stamp_ns = kBegin_ns + metres};
}

std::vector<StampedPose> corrected(const std::vector<SubmapPlace>& submaps, std::vector<StampedPose> poses,
                                   std::size_t piece = 1000) {
  TrajectoryCorrection correction;
  for (const SubmapPlace& submap : submaps) {
    correction.add(submap);
  }
  const auto pieces = [&](const auto& take) {
    for (std::size_t at = 0; at < poses.size(); at += piece) {
      take(std::span(poses).subspan(at, std::min(piece, poses.size() - at)));
    }
  };
  pieces([&](std::span<const StampedPose> odom) { correction.survey(odom); });
  pieces([&](std::span<StampedPose> odom) { correction.correct(odom); });
  return poses;
}

void expect_at(const StampedPose& pose, double x_m, double y_m, double yaw_rad) {
  EXPECT_NEAR(pose.map_T_scan.x_m, x_m, 1e-9);
  EXPECT_NEAR(pose.map_T_scan.y_m, y_m, 1e-9);
  EXPECT_NEAR(pose.map_T_scan.yaw_rad, yaw_rad, 1e-9);
}

const std::vector<SubmapPlace> kAside{submap_at(0, {0.0, 0.0, 0.0}), submap_at(10, {10.0, 1.0, 0.0}),
                                      submap_at(20, {20.0, 4.0, 0.0})};

TEST(TrajectoryCorrection, GoesInWithTheTravelFromOriginToOrigin) {
  const std::vector<StampedPose> map = corrected(kAside, straight_drive(30));
  expect_at(map[0], 0.0, 0.0, 0.0);
  expect_at(map[5], 5.0, 0.5, 0.0);
  expect_at(map[10], 10.0, 1.0, 0.0);
  expect_at(map[12], 12.0, 1.6, 0.0);
  expect_at(map[15], 15.0, 2.5, 0.0);
  expect_at(map[20], 20.0, 4.0, 0.0);
  expect_at(map[30], 30.0, 4.0, 0.0);
}

TEST(TrajectoryCorrection, ScansBeforeTheFirstOriginGoWithIt) {
  const std::vector<StampedPose> map = corrected({submap_at(4, {4.0, 2.0, 0.0})}, straight_drive(8));
  for (std::size_t i = 0; i < map.size(); ++i) {
    expect_at(map[i], static_cast<double>(i), 2.0, 0.0);
  }
}

TEST(TrajectoryCorrection, TurnsTheShorterWay) {
  constexpr double kHalf = std::numbers::pi;
  const std::vector<StampedPose> map =
      corrected({submap_at(0, {0.0, 0.0, kHalf - 0.1}), submap_at(10, {0.0, 0.0, 0.1 - kHalf})}, straight_drive(10));
  EXPECT_NEAR(std::abs(map[5].map_T_scan.yaw_rad), kHalf, 1e-9);
  EXPECT_NEAR(map[2].map_T_scan.yaw_rad, kHalf - 0.06, 1e-9);
}

TEST(TrajectoryCorrection, IsTheSameInPiecesOfAnyLength) {
  const std::vector<StampedPose> whole = corrected(kAside, straight_drive(30));
  for (const std::size_t piece : {1U, 7U, 31U}) {
    const std::vector<StampedPose> map = corrected(kAside, straight_drive(30), piece);
    for (std::size_t i = 0; i < map.size(); ++i) {
      EXPECT_EQ(map[i].map_T_scan.x_m, whole[i].map_T_scan.x_m) << i << " of pieces of " << piece;
      EXPECT_EQ(map[i].map_T_scan.y_m, whole[i].map_T_scan.y_m);
      EXPECT_EQ(map[i].map_T_scan.yaw_rad, whole[i].map_T_scan.yaw_rad);
    }
  }
}

TEST(TrajectoryCorrection, ASubmapWhoseOriginLacksCorrectsNone) {
  std::vector<StampedPose> drive = straight_drive(30);
  drive.erase(drive.begin() + 10);
  const std::vector<StampedPose> map = corrected(kAside, drive);
  expect_at(map[4], 4.0, 0.8, 0.0);
  expect_at(map[14], 15.0, 3.0, 0.0);
}

TEST(TrajectoryCorrection, WithoutASubmapPosesStay) {
  const std::vector<StampedPose> map = corrected({}, straight_drive(3));
  expect_at(map[3], 3.0, 0.0, 0.0);
}

}  // namespace
}  // namespace odoless
