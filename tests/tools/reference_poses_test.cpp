#include "tools/log/reference_poses.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/data.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tools/command/error.hpp"
#include "tools/log/scan_log.hpp"

namespace odoless {
namespace {

ReferencePoses reference_poses_of(std::string_view text) {
  const test::TemporaryFolder folder;
  return read_reference_poses(folder.file("poses", text));
}

void expect_pose(const ReferencePose& pose, double stamp_s, Pose2 expected) {
  EXPECT_NEAR(pose.stamp_s, stamp_s, 1e-6);
  EXPECT_NEAR(pose.pose.x_m, expected.x_m, 1e-9);
  EXPECT_NEAR(pose.pose.y_m, expected.y_m, 1e-9);
  EXPECT_NEAR(pose.pose.yaw_rad, expected.yaw_rad, 1e-9);
}

TEST(ReferencePoses, ReadsTheLasersPoseOfALog) {
  const ReferencePoses flaser = reference_poses_of(
      "PARAM a 1\nFLASER 2 9 9 1 2 0.3 4 5 6 10.5 h 0\nODOM 1 2 3\nFLASER 2 9 9 2 2 0.4 4 5 6 11.5 h 0\n");
  EXPECT_TRUE(flaser.is_log);
  EXPECT_TRUE(flaser.has_stamps);
  ASSERT_EQ(flaser.poses.size(), 2U);
  expect_pose(flaser.poses[0], 10.5, {1, 2, 0.3});
  expect_pose(flaser.poses[1], 11.5, {2, 2, 0.4});
  const ReferencePoses robot =
      reference_poses_of("ROBOTLASER1 0 -1 2 1 20 0 0 1 9 1 7 1 2 0.3 4 5 6 0 0 0 0 0 12.5 h 1\n");
  expect_pose(robot.poses.at(0), 12.5, {1, 2, 0.3});
}

TEST(ReferencePoses, SaysWhenTheStampsOfALogTellNothing) {
  const ReferencePoses log = reference_poses_of("FLASER 1 9 1 2 0.3 4 5 6 0 h 0\nFLASER 1 9 1 2 0.3 4 5 6 0 h 0\n");
  EXPECT_FALSE(log.has_stamps);
  EXPECT_EQ(log.poses.size(), 2U);
}

TEST(ReferencePoses, ReadsTextAndTum) {
  const ReferencePoses poses =
      reference_poses_of("# a comment\n1.5 1 2 0.5\n2.5 1 2 7 0 0 0.479425538604203 0.877582561890373\n");
  EXPECT_FALSE(poses.is_log);
  ASSERT_EQ(poses.poses.size(), 2U);
  expect_pose(poses.poses[0], 1.5, {1, 2, 0.5});
  expect_pose(poses.poses[1], 2.5, {1, 2, 1.0});
}

TEST(ReferencePoses, RefusesWhatIsNone) {
  for (const char* const text : {"", "# only\n", "Odometry 1 2 3\nLaser 1 2\n", "1 2 3\n", "1 2 3 4\n1 2 3 x\n",
                                 "1 2 3 nan\n", "1 2 3 4\nFLASER\n", "FLASER 1 9 1 2\n", "1 2 3 4\nhello\n"}) {
    EXPECT_THROW(static_cast<void>(reference_poses_of(text)), DataError) << text;
  }
  EXPECT_THROW(static_cast<void>(read_reference_poses("/nonexistent")), NoInputError);
}

TEST(ReferencePoses, OfALogAreOnePerScan) {
  ODOLESS_DATA_FILE(path, "freiburg-101-corrected.log.gz");
  const ReferencePoses reference = read_reference_poses(path);
  const ScanLog log = read_scan_log(path);
  ASSERT_EQ(reference.poses.size(), log.scans.size());
  EXPECT_EQ(reference.has_stamps, log.has_stamps);
  for (std::size_t i = 0; i < log.scans.size(); ++i) {
    ASSERT_NEAR(reference.poses[i].stamp_s, static_cast<double>(log.scans[i].stamp_ns) * 1e-9, 1e-6);
  }
  expect_pose(reference.poses.front(), 158.415, {0.108623, -0.0344101, 0.552197});
}

}  // namespace
}  // namespace odoless
