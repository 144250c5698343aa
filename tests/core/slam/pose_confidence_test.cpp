#include "core/slam/pose_confidence.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace odoless {
namespace {

constexpr double kPeriod_s = 0.2;
constexpr double kDriving = 0.4;  // that a robot has moved by from scan to scan

/// Goes on over scans that fit so well in what is known.
void scans(int count, double fit_share, PoseConfidence& confidence) {
  for (int i = 0; i < count; ++i) {
    confidence.move(1.0, 0.1, kPeriod_s);
    confidence.observe(fit_share, 1.0, kPeriod_s, kDriving);
  }
}

TEST(PoseConfidence, StaysCertainWhileScansFit) {
  PoseConfidence confidence{{}};
  scans(1000, 1.0, confidence);
  EXPECT_GT(confidence.right(), 0.99);
}

TEST(PoseConfidence, TakesContradictedTrackingForDriftAndNotForAJump) {
  PoseConfidence confidence{{}};
  scans(300, 0.3, confidence);
  EXPECT_LT(confidence.right(), 0.05);
  EXPECT_LT(confidence.jumped(), 0.2);
}

TEST(PoseConfidence, TakesContradictionAfterAnIncredibleStepForAJumpWithinTwoSeconds) {
  PoseConfidence confidence{{}};
  confidence.move(0.99, 0.1, kPeriod_s);
  EXPECT_GT(confidence.right(), 0.98);
  scans(10, 0.4, confidence);
  EXPECT_GT(confidence.jumped(), 0.8);
}

TEST(PoseConfidence, ScansThatFitTheMapConfirmAStepThatWasInDoubt) {
  PoseConfidence confidence{{}};
  confidence.move(0.5, 0.1, kPeriod_s);
  EXPECT_NEAR(confidence.right(), 0.5, 0.01);
  scans(30, 1.0, confidence);
  EXPECT_GT(confidence.right(), 0.95);
}

TEST(PoseConfidence, WhatTheMapDoesNotKnowSaysNothing) {
  PoseConfidence confidence{{}};
  confidence.move(0.5, 0.0, 0.0);
  const double before = confidence.right();
  confidence.observe(0.1, 0.0, kPeriod_s, 1.0);
  EXPECT_DOUBLE_EQ(confidence.right(), before);
}

TEST(PoseConfidence, AScanThatCountsForNothingNewConfirmsNothing) {
  PoseConfidence confidence{{}};
  confidence.move(0.5, 0.0, 0.0);
  for (int i = 0; i < 1000; ++i) {
    confidence.observe(1.0, 1.0, 0.0, 0.0);
  }
  EXPECT_NEAR(confidence.right(), 0.5, 0.01);
}

TEST(PoseConfidence, ARobotAtRestIsConfirmedMoreSlowlyThanOneThatDrives) {
  PoseConfidence driving{{}};
  PoseConfidence at_rest{{}};
  driving.move(0.5, 0.0, 0.0);
  at_rest.move(0.5, 0.0, 0.0);
  for (int i = 0; i < 10; ++i) {
    driving.observe(1.0, 1.0, kPeriod_s, kDriving);
    at_rest.observe(1.0, 1.0, kPeriod_s, 0.0);
  }
  EXPECT_GT(at_rest.right(), 0.52);
  EXPECT_GT(driving.right(), at_rest.right() + 0.1);
}

TEST(PoseConfidence, ARobotAtRestIsNotGivenUpBecauseOneCornerDoesNotFit) {
  PoseConfidence confidence{{}};
  confidence.move(0.94, 0.0, 0.0);
  for (int i = 0; i < 1000; ++i) {
    confidence.observe(0.5, 1.0, kPeriod_s, 0.0);
  }
  EXPECT_GT(confidence.right(), 0.9);
  scans(20, 0.5, confidence);
  EXPECT_GT(confidence.jumped(), 0.8) << "but where more and more of the map does not fit it is";
}

TEST(PoseConfidence, AMotionThatIsNotWellKnownLeadsToDrift) {
  PoseConfidence confidence{{}};
  confidence.slip(0.6);
  EXPECT_NEAR(confidence.right(), 0.6, 0.01);
  EXPECT_LT(confidence.jumped(), 0.01);
}

TEST(PoseConfidence, CountsScansByTheirTime) {
  PoseConfidence slow{{}};
  PoseConfidence fast{{}};
  slow.move(0.5, 0.0, 0.0);
  fast.move(0.5, 0.0, 0.0);
  slow.observe(0.3, 1.0, kPeriod_s, 1.0);
  for (int i = 0; i < 10; ++i) {
    fast.observe(0.3, 1.0, 0.1 * kPeriod_s, 0.1);
  }
  EXPECT_NEAR(slow.right(), fast.right(), 1e-9);
}

TEST(PoseConfidence, TellsForAboutAMinuteThatAStepMayHaveBeenWrong) {
  PoseConfidence confidence{{}};
  scans(300, 0.3, confidence);
  EXPECT_EQ(confidence.wrong_step(), 0.0) << "whatever the scans say";
  confidence.move(0.9, 0.1, kPeriod_s);
  EXPECT_NEAR(confidence.wrong_step(), 0.1, 1e-9);
  scans(300, 1.0, confidence);
  EXPECT_NEAR(confidence.wrong_step(), 0.1 * std::exp(-1.0), 1e-3);
  confidence.find();
  EXPECT_EQ(confidence.wrong_step(), 0.5) << "nor need a place that was found be the right one";
}

TEST(PoseConfidence, AnotherPlaceThatAloneFitsSpeaksAgainstIt) {
  PoseConfidence confidence{{}};
  confidence.move(0.8, 0.0, 0.0);
  confidence.contradict();
  EXPECT_GT(confidence.jumped(), 0.8);
}

TEST(PoseConfidence, IsAlwaysAProbability) {
  PoseConfidence confidence{{}};
  for (int i = 0; i < 1000; ++i) {
    confidence.move(i % 7 == 0 ? 0.0 : 1.0, 1e6, 1e6);
    confidence.observe(i % 3 == 0 ? -1e9 : 1e9, 1.0, 1e9, 1.0);
    confidence.slip(0.0);
    confidence.confirm();
    ASSERT_TRUE(confidence.right() >= 0.0 && confidence.right() <= 1.0 && std::isfinite(confidence.jumped()));
    ASSERT_LE(confidence.right() + confidence.jumped(), 1.0 + 1e-12);
  }
}

}  // namespace
}  // namespace odoless
