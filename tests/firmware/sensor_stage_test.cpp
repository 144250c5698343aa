#include "firmware/stages/sensor_stage.hpp"

#include <gtest/gtest.h>

#include <array>
#include <vector>

#include "tests/support/stamp_faults.hpp"

namespace odoless {
namespace {

constexpr std::int64_t kSweep_ns = 25'000'000;

/// A stage and what it is given, one scan after the other.
class SensorStageTest : public ::testing::Test {
 protected:
  [[nodiscard]] ScanVerdict give(std::int64_t stamp_ns, std::int64_t age_ns = 0) {
    ++given_;
    for (std::size_t i = 0; i < ranges_m_.size(); ++i) {  // a live laser's noise; the first beam always has a return
      if (i == 0 || ranges_m_[i] > 0.0F) {
        ranges_m_[i] = 1.0F + 0.001F * static_cast<float>((7 * given_ + 13 * static_cast<int>(i)) % 100);
      }
    }
    return give_same(stamp_ns, age_ns);
  }
  [[nodiscard]] ScanVerdict give_same(std::int64_t stamp_ns, std::int64_t age_ns = 0) {
    return stage_.process({.stamp_ns = stamp_ns, .angle_step_rad = 0.1, .ranges_m = ranges_m_}, stamp_ns + age_ns,
                          frame_);
  }

  SensorStage stage_{true, ScanParams{}.beams_max};
  ScanFrame frame_{ScanParams{}};
  std::array<float, 20> ranges_m_{1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1};
  int given_ = 0;
};

TEST_F(SensorStageTest, TakesScansInTheirOrderAndCountsWhatItRefuses) {
  EXPECT_EQ(give(1 * kSweep_ns), ScanVerdict::kAccepted);
  EXPECT_EQ(give(2 * kSweep_ns), ScanVerdict::kAccepted);
  EXPECT_EQ(give(2 * kSweep_ns), ScanVerdict::kDuplicate);
  EXPECT_EQ(give(1 * kSweep_ns), ScanVerdict::kOutOfOrder);
  EXPECT_EQ(give(3 * kSweep_ns, SensorStage::kLate_ns + 1), ScanVerdict::kLate);
  EXPECT_EQ(give(4 * kSweep_ns), ScanVerdict::kAccepted);
  EXPECT_EQ(stage_.counts().accepted, 3);
  EXPECT_EQ(stage_.counts().duplicate, 1);
  EXPECT_EQ(stage_.counts().out_of_order, 1);
  EXPECT_EQ(stage_.counts().late, 1);
}

TEST_F(SensorStageTest, ARefusedScanLeavesTheFrameAsItWas) {
  ASSERT_EQ(give(2 * kSweep_ns), ScanVerdict::kAccepted);
  ASSERT_NE(give(1 * kSweep_ns), ScanVerdict::kAccepted);
  EXPECT_EQ(frame_.stamp_ns(), 2 * kSweep_ns);
}

TEST_F(SensorStageTest, ASourceThatBeginsAnewIsFollowedAfterAWhile) {
  constexpr std::int64_t kLater_ns = 1'000'000'000'000;
  ASSERT_EQ(give(kLater_ns), ScanVerdict::kAccepted);
  for (int i = 1; i < SensorStage::kAnewScans; ++i) {
    ASSERT_EQ(give(i * kSweep_ns), ScanVerdict::kOutOfOrder) << i;
  }
  EXPECT_EQ(give(SensorStage::kAnewScans * kSweep_ns), ScanVerdict::kAccepted);
  EXPECT_EQ(give((SensorStage::kAnewScans + 1) * kSweep_ns), ScanVerdict::kAccepted);
}

TEST_F(SensorStageTest, StragglersNeverLookLikeANewBeginning) {
  ASSERT_EQ(give(100 * kSweep_ns), ScanVerdict::kAccepted);
  for (int i = 1; i < 5 * SensorStage::kAnewScans; ++i) {
    ASSERT_EQ(give((100 + i) * kSweep_ns), ScanVerdict::kAccepted);
    ASSERT_EQ(give(i * kSweep_ns), ScanVerdict::kOutOfOrder);  // late ones among good ones
  }
}

TEST_F(SensorStageTest, KnowsThePeriod) {
  for (int i = 1; i < 100; ++i) {
    ASSERT_EQ(give(i * kSweep_ns), ScanVerdict::kAccepted);
  }
  EXPECT_EQ(stage_.period_ns(), kSweep_ns);
}

TEST_F(SensorStageTest, ALiveScanOutOfOrderLeavesTheTimesAlone) {
  for (int i = 1; i < 50; ++i) {
    ASSERT_EQ(give(i * kSweep_ns), ScanVerdict::kAccepted);
    ASSERT_EQ(give((i - 1) * kSweep_ns), ScanVerdict::kOutOfOrder);
    EXPECT_EQ(frame_.time_ns(), i * kSweep_ns);
  }
  EXPECT_EQ(stage_.counts().times.scans, 49);
  EXPECT_EQ(stage_.counts().times.out_of_order, 0);
}

/// A recorded log, whose scans are in their order whatever their stamps say.
class ReplayedScans : public SensorStageTest {
 protected:
  ReplayedScans() { stage_ = SensorStage(false, ScanParams{}.beams_max); }
};

TEST_F(ReplayedScans, AreTakenAndTimedWhateverTheirStampsSay) {
  const std::vector<std::int64_t> stamps_ns = test::waver(test::even_times(2000, 200'000'000), 1);
  std::int64_t before_ns = -1;
  for (const std::int64_t stamp_ns : stamps_ns) {
    ASSERT_EQ(give(stamp_ns), ScanVerdict::kAccepted);
    ASSERT_EQ(frame_.stamp_ns(), stamp_ns) << "a scan is known by its stamp as told";
    ASSERT_GT(frame_.time_ns(), before_ns);
    before_ns = frame_.time_ns();
  }
  const SourceHealth& counts = stage_.counts();
  EXPECT_EQ(counts.accepted, 2000);
  EXPECT_EQ(counts.out_of_order, test::count_stamps(stamps_ns).out_of_order);
  EXPECT_NEAR(counts.times.period_s, 0.2, 0.01);
  EXPECT_NEAR(static_cast<double>(stage_.period_ns()), 0.2e9, 0.01e9);
}

TEST_F(ReplayedScans, OfTheSameStampAreTwoUnlessTheyAreTheSame) {
  ASSERT_EQ(give(1 * kSweep_ns), ScanVerdict::kAccepted);
  EXPECT_EQ(give_same(1 * kSweep_ns), ScanVerdict::kDuplicate);
  EXPECT_EQ(give(1 * kSweep_ns), ScanVerdict::kAccepted);
  EXPECT_GT(frame_.time_ns(), 1 * kSweep_ns);
  EXPECT_EQ(give_same(2 * kSweep_ns), ScanVerdict::kAccepted) << "a laser that stands still sees the same";
  EXPECT_EQ(stage_.counts().duplicate, 1);
  EXPECT_EQ(stage_.counts().accepted, 3);
}

TEST_F(ReplayedScans, AreNeverLate) {
  ASSERT_EQ(give(1 * kSweep_ns, 10 * SensorStage::kLate_ns), ScanVerdict::kAccepted);
  EXPECT_EQ(stage_.counts().late, 0);
}

TEST_F(SensorStageTest, TheSameRangesAgainAndAgainAreAStuckLaser) {
  for (int i = 1; i <= SensorStage::kStuckScans; ++i) {
    ASSERT_EQ(give_same(i * kSweep_ns), ScanVerdict::kAccepted);
    EXPECT_FALSE(stage_.is_stuck()) << i;
  }
  ASSERT_EQ(give_same((SensorStage::kStuckScans + 1) * kSweep_ns), ScanVerdict::kAccepted);
  EXPECT_TRUE(stage_.is_stuck());
  ASSERT_EQ(give((SensorStage::kStuckScans + 2) * kSweep_ns), ScanVerdict::kAccepted);
  EXPECT_FALSE(stage_.is_stuck());
}

TEST_F(SensorStageTest, ScansWithoutReturnsAreBlind) {
  ranges_m_.fill(0.0F);
  for (int i = 1; i <= SensorStage::kBlindScans; ++i) {
    EXPECT_FALSE(stage_.is_blind());
    ASSERT_EQ(give_same(i * kSweep_ns), ScanVerdict::kAccepted);
  }
  EXPECT_TRUE(stage_.is_blind());
}

}  // namespace
}  // namespace odoless
