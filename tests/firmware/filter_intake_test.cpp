#include "firmware/threads/filter_intake.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "core/geometry/pose2_covariance.hpp"
#include "firmware/sources/lcm_source.hpp"
#include "tests/support/temporary_folder.hpp"

namespace odoless {
namespace {

constexpr std::int64_t kScan_ns = 100'000'000;

/// The robot goes round in a circle; motion k leads from scan k - 1 to scan k.
Pose2 odom_T_scan(int index) { return {0.1 * index, 0.02 * index * index, 0.05 * index}; }

Motion motion(int index) {
  Motion motion =
      Motion::between((index - 1) * kScan_ns, index * kScan_ns, odom_T_scan(index - 1).inverse() * odom_T_scan(index));
  motion.odom_T_current = odom_T_scan(index);
  motion.set_error(
      ErrorProcess::independent(motion.previous_T_current, Eigen::Vector3d(1e-4, 1e-4, 1e-5).asDiagonal()));
  return motion;
}

/// The intake, fed as a socket would, and what comes out for the filter.
class FilterIntakeTest : public ::testing::Test {
 protected:
  void scan(int index) {
    ranges_m_.assign(16, 1.0F + 0.01F * static_cast<float>(index % 7));
    intake_.on_scan({.stamp_ns = index * kScan_ns,
                     .angle_step_rad = 0.1,
                     .beam_period_ns = beam_period_ns_,
                     .ranges_m = ranges_m_});
  }

  /// Of all that has come out: whether each has its scan, and the sum of the motions.
  void drain() {
    for (MotionMessage message; pipeline_.motions.try_pop(message);) {
      has_scan_.push_back(message.slot != kNoSlot);
      sum_ = sum_ * message.motion.previous_T_current;
      to_stamp_ns_ = message.motion.to_stamp_ns;
      if (message.slot != kNoSlot) {
        const ScanFrame& scan = pipeline_.pool.at(message.slot);
        EXPECT_EQ(scan.stamp_ns(), message.motion.to_stamp_ns);
        turned_by_rad_.push_back(scan.angle_rad(scan.size() - 1) - 0.1 * (scan.size() - 1));
        ASSERT_TRUE(pipeline_.slots_from_filter.try_push(message.slot));
      }
    }
  }

  void expect_sum_is(int first, int last) {
    const Pose2 expected = odom_T_scan(first).inverse() * odom_T_scan(last);
    EXPECT_NEAR(sum_.x_m, expected.x_m, 1e-9);
    EXPECT_NEAR(sum_.y_m, expected.y_m, 1e-9);
    EXPECT_NEAR(sum_.yaw_rad, expected.yaw_rad, 1e-9);
    EXPECT_EQ(to_stamp_ns_, last * kScan_ns);
  }

  /// As the sensor's report has it.
  std::int64_t motions_refused() {
    const LcmSource source({}, "SCAN", 16);
    intake_.report(source, {}, {});
    EXPECT_TRUE(pipeline_.sensor.report.update());
    return pipeline_.sensor.report.value().source.motions_refused;
  }

  Pipeline pipeline_{PipelineParams{}, RobotParams{}, false};
  ManualClock clock_{1'700'000'000'000'000'000};
  FilterIntake intake_{pipeline_, clock_, {}, {.speed_max_mps = 100.0, .turn_rate_max_radps = 100.0}};
  std::vector<float> ranges_m_;
  std::int64_t beam_period_ns_ = 0;  ///< as the scans tell it
  std::vector<bool> has_scan_;
  std::vector<double> turned_by_rad_;  ///< the last beam of each scan, by deskewing
  Pose2 sum_;
  std::int64_t to_stamp_ns_ = 0;
};

TEST_F(FilterIntakeTest, BringsEachMotionTogetherWithItsScan) {
  for (int index = 1; index <= 100; ++index) {  // far more than there are slots
    scan(index);
    intake_.on_motion(motion(index));
    drain();
    ASSERT_EQ(has_scan_.size(), static_cast<std::size_t>(index));
    ASSERT_TRUE(has_scan_.back()) << index;
  }
  expect_sum_is(0, 100);
}

// The robot turns by 0.05 rad per scan; 16 beams, 5 ms apart.
TEST_F(FilterIntakeTest, DeskewsScansWithTheSpeedOfTheMotionBefore) {
  beam_period_ns_ = 5'000'000;
  for (int index = 1; index <= 3; ++index) {
    scan(index);
    intake_.on_motion(motion(index));
  }
  drain();
  ASSERT_EQ(turned_by_rad_.size(), 3U);
  EXPECT_EQ(turned_by_rad_[0], 0.0) << "no speed is known yet";
  EXPECT_NEAR(turned_by_rad_[1], 0.5 * 15 * 0.005, 1e-9);
  EXPECT_NEAR(turned_by_rad_[2], 0.5 * 15 * 0.005, 1e-9);
}

TEST_F(FilterIntakeTest, AMotionWaitsForAScanThatComesAfterIt) {
  intake_.on_motion(motion(1));
  drain();
  EXPECT_TRUE(has_scan_.empty());
  scan(1);
  drain();
  EXPECT_EQ(has_scan_, std::vector{true});
}

TEST_F(FilterIntakeTest, AMotionWhoseScanIsLostOnlyComposes) {
  scan(1);
  intake_.on_motion(motion(1));
  intake_.on_motion(motion(2));
  scan(3);
  intake_.on_motion(motion(3));
  drain();
  EXPECT_EQ(has_scan_, (std::vector{true, false, true}));
  expect_sum_is(0, 3);
}

TEST_F(FilterIntakeTest, AsManyScansAsTheQueueHoldsWaitForASlowMatcher) {
  const int many = static_cast<int>(pipeline_.scans.capacity());
  for (int index = 1; index <= many; ++index) {
    scan(index);
  }
  for (int index = 1; index <= many; ++index) {
    intake_.on_motion(motion(index));
  }
  drain();
  EXPECT_EQ(has_scan_, std::vector(static_cast<std::size_t>(many), true));
  expect_sum_is(0, many);
}

TEST_F(FilterIntakeTest, OfMoreScansThanTheQueueHoldsTheOldestGoAndAreCounted) {
  const int many = static_cast<int>(pipeline_.scans.capacity()) + 3;
  for (int index = 1; index <= many; ++index) {
    scan(index);
  }
  for (int index = 1; index <= many; ++index) {
    intake_.on_motion(motion(index));
  }
  drain();
  EXPECT_EQ(std::count(has_scan_.begin(), has_scan_.end(), false), 3);
  EXPECT_TRUE(has_scan_.back());
  EXPECT_EQ(pipeline_.scans.evicted(), 3U);
  expect_sum_is(0, many);
}

TEST_F(FilterIntakeTest, TheNextMotionMakesUpForLostOnes) {
  scan(1);
  intake_.on_motion(motion(1));
  scan(2);
  scan(3);
  scan(4);
  intake_.on_motion(motion(4));
  drain();
  EXPECT_EQ(has_scan_, (std::vector{true, true}));
  expect_sum_is(0, 4);
}

TEST_F(FilterIntakeTest, TheFirstMotionMakesUpForAllThatWereLostBeforeIt) {
  scan(7);
  intake_.on_motion(motion(7));
  scan(8);
  intake_.on_motion(motion(8));
  drain();
  EXPECT_EQ(has_scan_, (std::vector{true, true}));
  const Pose2 expected = odom_T_scan(8);
  EXPECT_NEAR(sum_.x_m, expected.x_m, 1e-9);
  EXPECT_NEAR(sum_.y_m, expected.y_m, 1e-9);
  EXPECT_NEAR(sum_.yaw_rad, expected.yaw_rad, 1e-9);
}

TEST_F(FilterIntakeTest, WhatIsMadeUpForIsAsUncertainAsItIsLong) {
  intake_.on_motion(motion(1));
  intake_.on_motion(motion(4));
  scan(4);
  MotionMessage message;
  ASSERT_TRUE(pipeline_.motions.try_pop(message));
  ASSERT_TRUE(pipeline_.motions.try_pop(message));
  // Two periods are missing, from scan 1 to 3; their yaw turns the way from 3 to 4.
  const Pose2 missing = odom_T_scan(1).inverse() * odom_T_scan(3);
  const Eigen::Matrix3d covariance = Eigen::Vector3d(2e-4, 2e-4, 2e-5).asDiagonal();
  const Eigen::Matrix3d expected = composed_covariance(missing, turned(covariance, missing.yaw_rad),
                                                       motion(4).previous_T_current, motion(4).covariance());
  EXPECT_LT((message.motion.covariance() - expected).norm(), 1e-12);
  EXPECT_GE(message.motion.covariance()(0, 0), 3e-4);
  EXPECT_EQ(message.motion.duration_ns, 3 * kScan_ns);
}

TEST_F(FilterIntakeTest, TwiceOrTooLateCountsOnce) {
  for (const int index : {1, 2, 2, 1, 3}) {
    scan(index);
    intake_.on_motion(motion(index));
  }
  drain();
  EXPECT_EQ(has_scan_.size(), 3U);
  expect_sum_is(0, 3);
}

TEST_F(FilterIntakeTest, AMotionOfAFarTimeHoldsUpNoScanAndIsCounted) {
  Motion forged = motion(3);
  forged.to_stamp_ns += 3'600'000'000'000;
  forged.from_stamp_ns += 3'600'000'000'000;
  for (int index = 1; index <= 5; ++index) {
    scan(index);
    intake_.on_motion(motion(index));
    intake_.on_motion(forged);
  }
  drain();
  EXPECT_EQ(has_scan_, std::vector(5, true));
  expect_sum_is(0, 5);
  EXPECT_EQ(motions_refused(), 5);
}

TEST_F(FilterIntakeTest, AClockThatIsSetBackLosesNoWay) {
  constexpr int kBack = 20;
  constexpr std::int64_t kBack_ns = kBack * kScan_ns;
  for (int index = 31; index <= 33; ++index) {
    scan(index);
    intake_.on_motion(motion(index));
  }
  for (int index = 34; index <= 60; ++index) {
    Motion set_back = motion(index);
    set_back.from_stamp_ns -= kBack_ns;
    set_back.to_stamp_ns -= kBack_ns;
    scan(index - kBack);
    clock_.advance_by(kScan_ns);
    intake_.on_motion(set_back);
    drain();
  }
  EXPECT_GE(std::count(has_scan_.begin(), has_scan_.end(), true), 20);
  const Pose2 expected = odom_T_scan(60);  // the first one makes up for all before it
  EXPECT_NEAR(sum_.x_m, expected.x_m, 1e-9);
  EXPECT_NEAR(sum_.y_m, expected.y_m, 1e-9);
  EXPECT_EQ(to_stamp_ns_, 60 * kScan_ns - kBack_ns);
}

TEST_F(FilterIntakeTest, AFilterThatIsBusyLosesNoMotion) {
  const int many = 3 * static_cast<int>(pipeline_.motions.capacity());
  for (int index = 1; index <= many; ++index) {
    scan(index);
    intake_.on_motion(motion(index));
  }
  drain();
  scan(many + 1);
  intake_.on_motion(motion(many + 1));
  drain();
  expect_sum_is(0, many + 1);
}

}  // namespace
}  // namespace odoless
