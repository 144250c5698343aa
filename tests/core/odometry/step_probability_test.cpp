#include "core/odometry/step_probability.hpp"

#include <gtest/gtest.h>

namespace odoless {
namespace {

double probability(double period_s, double score_share) {
  return step_probability({}, {.period_s = period_s, .matched = true, .score_share = score_share});
}

TEST(StepProbability, AStepBetweenScansThatFollowEachOtherIsCertainOrIfItMatchesPoorlyNearlySo) {
  EXPECT_GT(probability(0.1, 1.0), 0.9999);
  EXPECT_GT(probability(0.1, 0.1), 0.95);
  EXPECT_LT(probability(0.1, 0.1), 0.98) << "the robot may have been carried";
}

TEST(StepProbability, FallsWithTheTimeThatNobodyLooked) {
  double last = 1.0;
  for (const double period_s : {0.5, 1.0, 2.0, 4.0, 8.0}) {
    EXPECT_LT(probability(period_s, 0.8), last) << period_s;
    last = probability(period_s, 0.8);
  }
  EXPECT_LT(last, 0.2);
}

TEST(StepProbability, GrowsWithTheScore) {
  EXPECT_LT(probability(3.0, 0.4), 0.1);
  EXPECT_GT(probability(3.0, 0.7), 0.3);
  EXPECT_GT(probability(3.0, 1.0), 0.9);
}

TEST(StepProbability, WhatIsNotMatchedOrHasNoUsualScoreIsAsProbableAsTheTimeHasIt) {
  const double neutral = probability(2.0, 0.7);
  EXPECT_NEAR(step_probability({}, {.period_s = 2.0}), neutral, 1e-12);
  EXPECT_NEAR(step_probability({}, {.period_s = 2.0, .matched = true}), neutral, 1e-12);
}

TEST(StepProbability, AnUncertainTimeCountsAsALongerOne) {
  EXPECT_NEAR(step_probability({}, {.period_s = 0.2, .period_sd_s = 3.0}), step_probability({}, {.period_s = 1.7}),
              1e-12);
  EXPECT_LT(step_probability({}, {.period_s = 0.2, .period_sd_s = 3.0}),
            step_probability({}, {.period_s = 0.2}) - 0.01);
}

TEST(StepProbability, NobodyIsSureOfAStepThatNoRobotCanMake) {
  EXPECT_LT(step_probability({}, {.period_s = 0.1, .matched = true, .is_within_limits = false, .score_share = 0.7}),
            0.6);
}

TEST(StepProbability, ASlowRobotIsKnownLonger) {
  const StepSigns signs{.period_s = 3.0, .matched = true, .score_share = 0.7};
  EXPECT_GT(step_probability({.speed_max_mps = 0.3}, signs), 0.99);
  EXPECT_LT(step_probability({.speed_max_mps = 2.5}, signs), 0.7);
}

}  // namespace
}  // namespace odoless
