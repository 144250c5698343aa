#include "core/slam/pose_search.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace odoless {
namespace {

TEST(Climb, FindsThePeakOfASmoothScore) {
  const Pose2 peak{0.07, -0.04, 0.013};
  int scores = 0;
  const auto score = [&](const Pose2& pose) {
    ++scores;
    return -std::hypot(pose.x_m - peak.x_m, pose.y_m - peak.y_m, 3.0 * (pose.yaw_rad - peak.yaw_rad));
  };
  const ScoredPose found = climb({}, 0.05, 0.02, 20, score);
  EXPECT_NEAR(found.pose.x_m, peak.x_m, 0.005);
  EXPECT_NEAR(found.pose.y_m, peak.y_m, 0.005);
  EXPECT_NEAR(found.pose.yaw_rad, peak.yaw_rad, 0.003);
  EXPECT_EQ(found.score, score(found.pose));
  EXPECT_EQ(scores, 1 + 6 * 20 + 1);
}

TEST(Climb, StaysWhereNothingIsBetter) {
  const ScoredPose found = climb({1.0, 2.0, 3.0}, 0.1, 0.1, 5, [](const Pose2&) { return 4.0; });
  EXPECT_EQ(found.pose.x_m, 1.0);
  EXPECT_EQ(found.pose.yaw_rad, 3.0);
  EXPECT_EQ(found.score, 4.0);
}

TEST(Climb, ScoresOnceWithoutRounds) {
  int scores = 0;
  const ScoredPose found = climb({1.0, 0.0, 0.0}, 0.1, 0.1, 0, [&](const Pose2& pose) { return ++scores + pose.x_m; });
  EXPECT_EQ(scores, 1);
  EXPECT_EQ(found.score, 2.0);
}

}  // namespace
}  // namespace odoless
