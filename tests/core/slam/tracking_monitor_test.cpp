#include "core/slam/tracking_monitor.hpp"

#include <gtest/gtest.h>

namespace odoless {
namespace {

constexpr double kGood = 0.8;
constexpr double kBad = 0.1;

class TrackingMonitorTest : public ::testing::Test {
 protected:
  /// Scans of this fit, so far apart.
  void scans(int count, double fit, double period_s = 0.1, bool suspect = false) {
    for (int i = 0; i < count; ++i) {
      stamp_ns_ += static_cast<std::int64_t>(period_s * 1e9);
      fits_ = monitor_.add(fit, suspect, stamp_ns_);
    }
  }

  TrackingParams params_{.fit_min = 0.3, .suspect_fit_min = 0.5, .lost_after_s = 0.75};
  TrackingMonitor monitor_{params_};
  std::int64_t stamp_ns_ = 1'000'000'000;
  bool fits_ = false;
};

TEST_F(TrackingMonitorTest, IsSureWhileScansFit) {
  scans(100, kGood);
  EXPECT_EQ(monitor_.state(), Tracking::kSure);
  EXPECT_TRUE(fits_);
}

TEST_F(TrackingMonitorTest, DoubtsAtTheFirstScanThatDoesNotFitAndIsSureAgainAfterOneThatDoes) {
  scans(10, kGood);
  scans(1, kBad);
  EXPECT_FALSE(fits_);
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
  scans(20, 0.4);
  EXPECT_EQ(monitor_.state(), Tracking::kSure);
  scans(20, 0.4, 0.1, true);
  EXPECT_EQ(monitor_.state(), Tracking::kLost);
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
