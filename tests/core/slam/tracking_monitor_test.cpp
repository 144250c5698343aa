#include "core/slam/tracking_monitor.hpp"

#include <gtest/gtest.h>

namespace odoless {
namespace {

constexpr TrackingSigns kGood{.fit = 0.8};
constexpr TrackingSigns kBad{.fit = 0.1};
constexpr TrackingSigns kPassable{.fit = 0.4};

class TrackingMonitorTest : public ::testing::Test {
 protected:
  /// Scans of this kind, so far apart.
  void scans(int count, const TrackingSigns& signs, double period_s = 0.1) {
    for (int i = 0; i < count; ++i) {
      stamp_ns_ += static_cast<std::int64_t>(period_s * 1e9);
      monitor_.add(signs, stamp_ns_);
    }
  }

  TrackingParams params_{.fit_min = 0.3,
                         .suspect_fit_min = 0.5,
                         .torn_fit_min = 0.7,
                         .torn_for_s = 1.05,
                         .lost_after_s = 0.45,
                         .contradicted_after_s = 0.75};
  TrackingMonitor monitor_{params_};
  std::int64_t stamp_ns_ = 1'000'000'000;
};

TEST_F(TrackingMonitorTest, IsSureWhileScansFit) {
  scans(100, kGood);
  EXPECT_EQ(monitor_.state(), Tracking::kSure);
  EXPECT_TRUE(monitor_.is_trusted());
}

TEST_F(TrackingMonitorTest, DoubtsAtTheFirstScanThatDoesNotFitAndIsSureAgainAfterOneThatDoes) {
  scans(10, kGood);
  scans(1, kBad);
  EXPECT_FALSE(monitor_.is_trusted());
  EXPECT_EQ(monitor_.state(), Tracking::kDoubtful);
  scans(1, kGood);
  EXPECT_EQ(monitor_.state(), Tracking::kSure);
}

TEST_F(TrackingMonitorTest, IsLostAfterTheTimeGivenAndStaysSo) {
  scans(10, kGood);
  scans(7, kBad);
  EXPECT_EQ(monitor_.state(), Tracking::kDoubtful);
  scans(1, kBad);
  EXPECT_EQ(monitor_.state(), Tracking::kLost);
  scans(100, kGood);
  EXPECT_EQ(monitor_.state(), Tracking::kLost);
  monitor_.reset();
  EXPECT_EQ(monitor_.state(), Tracking::kSure);
}

TEST_F(TrackingMonitorTest, IsLostSoonerAfterAScanThatMatchedNothing) {
  scans(10, kGood);
  scans(5, kBad);
  EXPECT_EQ(monitor_.state(), Tracking::kDoubtful);
  scans(10, kGood);
  scans(1, {.fit = kBad.fit, .torn = true});
  scans(3, kBad);
  EXPECT_EQ(monitor_.state(), Tracking::kDoubtful);
  scans(1, kBad);
  EXPECT_EQ(monitor_.state(), Tracking::kLost);
}

TEST_F(TrackingMonitorTest, OnceItHasGoneOnWithoutBeingFoundItIsNeverSure) {
  scans(10, kGood);
  scans(8, kBad);
  ASSERT_EQ(monitor_.state(), Tracking::kLost);
  monitor_.resume();
  scans(100, kGood);
  EXPECT_EQ(monitor_.state(), Tracking::kDoubtful);
  EXPECT_TRUE(monitor_.is_trusted());
  monitor_.reset();
  EXPECT_EQ(monitor_.state(), Tracking::kSure);
}

TEST_F(TrackingMonitorTest, ScansThatFitNowAndThenOnlyDelayIt) {
  for (int i = 0; i < 20; ++i) {
    scans(2, kBad);
    scans(1, kGood);
  }
  EXPECT_EQ(monitor_.state(), Tracking::kLost);
}

TEST_F(TrackingMonitorTest, AsManyThatFitAsNotAreNoReason) {
  for (int i = 0; i < 100; ++i) {
    scans(1, kBad);
    scans(1, kGood);
  }
  EXPECT_NE(monitor_.state(), Tracking::kLost);
}

TEST_F(TrackingMonitorTest, SuspicionRaisesTheBar) {
  scans(20, kPassable);
  EXPECT_EQ(monitor_.state(), Tracking::kSure);
  scans(20, {.fit = kPassable.fit, .suspect = true});
  EXPECT_EQ(monitor_.state(), Tracking::kLost);
}

TEST_F(TrackingMonitorTest, ARobotThatWasCarriedIsLostAtOnceHoweverWellTheScanFits) {
  scans(10, kGood);
  scans(1, {.fit = kGood.fit, .carried = true});
  EXPECT_EQ(monitor_.state(), Tracking::kLost);
}

TEST_F(TrackingMonitorTest, AfterAScanThatMatchesNothingScansMustFitWell) {
  scans(1, {.fit = kPassable.fit, .torn = true});
  scans(20, kPassable);
  EXPECT_EQ(monitor_.state(), Tracking::kLost);
}

TEST_F(TrackingMonitorTest, AfterSuchAScanNothingIsTrustedForAWhileHoweverWellItFits) {
  scans(1, {.fit = kGood.fit, .torn = true});
  scans(10, kGood);
  EXPECT_FALSE(monitor_.is_trusted());
  EXPECT_EQ(monitor_.state(), Tracking::kDoubtful);
  scans(1, kGood);
  EXPECT_TRUE(monitor_.is_trusted());
  EXPECT_EQ(monitor_.state(), Tracking::kSure);
}

TEST_F(TrackingMonitorTest, AfterATearScansMustFitAsIsUsual) {
  constexpr double kFit = 0.72;  // enough by itself
  scans(1, {.fit = kFit, .torn = true, .usual_fit = 0.8});
  scans(20, {.fit = kFit, .usual_fit = 0.8});
  EXPECT_EQ(monitor_.state(), Tracking::kSure);
  scans(1, {.fit = kFit, .torn = true, .usual_fit = 1.0});
  scans(20, {.fit = kFit, .usual_fit = 1.0});
  EXPECT_EQ(monitor_.state(), Tracking::kLost);
}

TEST_F(TrackingMonitorTest, OnceFoundItIsInDoubtUntilScansHaveFittedForAWhile) {
  monitor_.try_anew();
  scans(10, kGood);
  EXPECT_EQ(monitor_.state(), Tracking::kDoubtful);
  scans(2, kGood);
  EXPECT_EQ(monitor_.state(), Tracking::kSure);
  monitor_.try_anew();
  scans(9, kPassable);
  EXPECT_EQ(monitor_.state(), Tracking::kLost) << "it was the wrong place";
}

TEST_F(TrackingMonitorTest, AHoleInTheScansCountsForLittleAndOneScanForNothingByItself) {
  scans(5, kGood);
  scans(2, kBad, 100.0);
  EXPECT_EQ(monitor_.state(), Tracking::kDoubtful);
  scans(1, kBad, 100.0);
  EXPECT_EQ(monitor_.state(), Tracking::kLost);
}

}  // namespace
}  // namespace odoless
