#include "core/slam/usual_motion.hpp"

#include <gtest/gtest.h>

namespace odoless {
namespace {

UsualMotion after(int steps, const Pose2& step) {
  UsualMotion usual{TrackingParams{}};
  for (int i = 0; i < steps; ++i) {
    usual.add(step);
  }
  return usual;
}

TEST(UsualMotion, ARobotThatDrivesHasDenseScans) { EXPECT_TRUE(after(100, {0.1, 0.0, 0.1}).is_dense()); }

TEST(UsualMotion, ScansThatAreFarApartAreNotDense) { EXPECT_FALSE(after(5, {1.5, 0.0, 0.8}).is_dense()); }

// It may be the very step that broke tracking: who stops looking then is sure of a wrong pose.
TEST(UsualMotion, OneFarStepAmongManyChangesNothing) {
  UsualMotion usual = after(100, {0.1, 0.0, 0.1});
  usual.add({0.1, 0.0, 1.2});
  EXPECT_TRUE(usual.is_dense());
  for (int i = 0; i < 4; ++i) {
    usual.add({0.1, 0.0, 1.2});
  }
  EXPECT_FALSE(usual.is_dense());
}

TEST(UsualMotion, ForgetsOneFarStep) {
  UsualMotion usual = after(1, {1.0, 0.0, 0.0});
  EXPECT_FALSE(usual.is_dense());
  for (int i = 0; i < 100; ++i) {
    usual.add({0.1, 0.0, 0.0});
  }
  EXPECT_TRUE(usual.is_dense());
}

}  // namespace
}  // namespace odoless
