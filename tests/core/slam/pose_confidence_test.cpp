#include "core/slam/pose_confidence.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace odoless {
namespace {

constexpr double kPeriod_s = 0.2;

/// Goes on over scans that fit so well in what is known.
void scans(int count, double fit_share, PoseConfidence& confidence) {
  for (int i = 0; i < count; ++i) {
    confidence.move(1.0, 0.1, kPeriod_s);
    confidence.observe(fit_share, 1.0, kPeriod_s);
  }
}

TEST(PoseConfidence, StaysCertainWhileScansFit) {
  PoseConfidence confidence{{}};
  scans(1000, 1.0, confidence);
  EXPECT_GT(confidence.right(), 0.99);
}

TEST(PoseConfidence, TakesContradictedTrackingForDriftAtFirstAndForAJumpInTheLongRun) {
  PoseConfidence confidence{{}};
  scans(18, 0.3, confidence);
  EXPECT_LT(confidence.right(), 0.5);
  EXPECT_LT(confidence.jumped(), 0.2);
  scans(300, 0.3, confidence);
  EXPECT_GT(confidence.jumped(), 0.8);
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
  confidence.observe(0.1, 0.0, kPeriod_s);
  EXPECT_DOUBLE_EQ(confidence.right(), before);
}

TEST(PoseConfidence, CountsScansByTheirTime) {
  PoseConfidence slow{{}};
  PoseConfidence fast{{}};
  slow.move(0.5, 0.0, 0.0);
  fast.move(0.5, 0.0, 0.0);
  slow.observe(1.0, 1.0, kPeriod_s);
  for (int i = 0; i < 10; ++i) {
    fast.observe(1.0, 1.0, 0.1 * kPeriod_s);
  }
  EXPECT_NEAR(slow.right(), fast.right(), 1e-9);
}

TEST(PoseConfidence, AnotherPlaceThatAloneFitsSpeaksAgainstIt) {
  PoseConfidence drifting{{}};
  drifting.lose_track();
  drifting.move(0.8, 0.0, 0.0);
  drifting.contradict();
  EXPECT_GT(drifting.jumped(), 0.8) << "drift does not lead to another place";
  PoseConfidence confidence{{}};
  confidence.move(0.8, 0.0, 0.0);
  confidence.contradict();
  EXPECT_GT(confidence.jumped(), 0.8);
}

TEST(PoseConfidence, IsAlwaysAProbability) {
  PoseConfidence confidence{{}};
  for (int i = 0; i < 1000; ++i) {
    confidence.move(i % 7 == 0 ? 0.0 : 1.0, 1e6, 1e6);
    confidence.observe(i % 3 == 0 ? -1e9 : 1e9, 1.0, 1e9);
    ASSERT_TRUE(confidence.right() >= 0.0 && confidence.right() <= 1.0 && std::isfinite(confidence.jumped()));
    ASSERT_LE(confidence.right() + confidence.jumped(), 1.0 + 1e-12);
  }
}

}  // namespace
}  // namespace odoless
