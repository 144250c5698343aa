#include "firmware/stages/motion_guard.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "tests/support/times.hpp"

namespace odoless {
namespace {

constexpr std::int64_t kGuardPeriod_ns = 25'000'000;
using test::kSecond;
constexpr std::int64_t kHour_ns = 3600 * kSecond;
constexpr double kScanStep_m = 0.02;

/// A matcher whose robot goes straight on, and a guard that hears each motion when it is made.
class MotionGuardTest : public ::testing::Test {
 protected:
  /// The next one, as it is made.
  Motion next() {
    now_ns_ += kGuardPeriod_ns;
    stamp_ns_ += kGuardPeriod_ns;
    odom_T_scan_ = odom_T_scan_ * Pose2{kScanStep_m, 0.0, 0.0};
    return motion();
  }
  [[nodiscard]] Motion motion() const {
    Motion motion = Motion::between(stamp_ns_ - kGuardPeriod_ns, stamp_ns_, {kScanStep_m, 0.0, 0.0});
    motion.odom_T_current = odom_T_scan_;
    motion.set_error(
        ErrorProcess::independent(motion.previous_T_current, Eigen::Vector3d(1e-4, 1e-4, 1e-5).asDiagonal()));
    return motion;
  }
  MotionVerdict judge(const Motion& motion) { return guard_.judge(motion, now_ns_); }

  /// How many of the next ones are not taken before one is; `verdict_` says as what.
  int refused_before_one_is_taken() {
    for (int count = 0; count < 1000; ++count) {
      verdict_ = judge(next());
      if (verdict_ != MotionVerdict::kRefused && verdict_ != MotionVerdict::kOld) {
        return count;
      }
    }
    return -1;
  }
  void run(int motions) {
    for (int i = 0; i < motions; ++i) {
      ASSERT_EQ(judge(next()), MotionVerdict::kFollows) << i;
    }
  }
  void begin() { ASSERT_EQ(judge(next()), MotionVerdict::kBegins); }

  /// One that was changed is refused and counted, and the next good one taken.
  template <class Change>
  void expect_refused(Change change) {
    Motion bad = next();
    change(bad);
    const std::int64_t before = guard_.refused();
    EXPECT_EQ(judge(bad), MotionVerdict::kRefused);
    EXPECT_EQ(guard_.refused(), before + 1);
    EXPECT_EQ(judge(next()), MotionVerdict::kFollows);
  }

  MotionGuard guard_{RobotLimits{}};
  std::int64_t now_ns_ = 1'700'000'000 * kSecond;
  std::int64_t stamp_ns_ = 1'600'000'000 * kSecond;  // a log's
  Pose2 odom_T_scan_{100.0, 50.0, 1.0};
  MotionVerdict verdict_ = MotionVerdict::kRefused;
};

TEST_F(MotionGuardTest, TakesAStreamWithGapsAndAtAnotherPace) {
  begin();
  run(100);
  stamp_ns_ += kHour_ns;  // the laser was off
  now_ns_ += kHour_ns;
  run(100);
  for (int i = 0; i < 1000; ++i) {  // a log at four times its pace
    stamp_ns_ += 3 * kGuardPeriod_ns;
    ASSERT_EQ(judge(next()), MotionVerdict::kFollows) << i;
  }
  EXPECT_EQ(guard_.refused(), 0);
}

TEST_F(MotionGuardTest, RefusesStampsFarFromNow) {
  begin();
  run(10);
  for (const std::int64_t off_ns : {10 * kSecond, kHour_ns, 100'000 * kHour_ns, -10 * kSecond, -kHour_ns}) {
    SCOPED_TRACE(off_ns);
    expect_refused([off_ns](Motion& motion) {
      motion.from_stamp_ns += off_ns;
      motion.to_stamp_ns += off_ns;
    });
  }
  run(100);
}

TEST_F(MotionGuardTest, RefusesStepsThatTheRobotCannotMake) {
  begin();
  run(10);
  expect_refused([](Motion& motion) { motion.previous_T_current.x_m = 5.0; });
  expect_refused([](Motion& motion) { motion.previous_T_current.y_m = -5.0; });
  expect_refused([](Motion& motion) { motion.previous_T_current.yaw_rad = 3.0; });
  expect_refused([](Motion& motion) { motion.odom_T_current.y_m += 5.0; });
  expect_refused([](Motion& motion) {  // in an hour it could
    motion.previous_T_current.x_m = 5.0;
    motion.from_stamp_ns -= kHour_ns;
    motion.duration_ns = kHour_ns;
  });
}

TEST_F(MotionGuardTest, RefusesCovariancesThatAreNoneOrTooWide) {
  begin();
  run(10);
  expect_refused([](Motion& motion) { motion.error_noise[0] = 1e300; });
  expect_refused([](Motion& motion) { motion.error_noise[0] = 1e6; });
  expect_refused([](Motion& motion) { motion.error_noise[0] = -1e-4; });
  expect_refused([](Motion& motion) { motion.error_noise[1] = 1e-4; });                           // not symmetric
  expect_refused([](Motion& motion) { motion.error_noise[1] = motion.error_noise[5] = 2e-4; });   // not positive
  expect_refused([](Motion& motion) { motion.error_noise[3] = motion.error_noise[15] = 1e-3; });  // of a sure speed
  expect_refused([](Motion& motion) { motion.map_slip[0] = 1e6; });
  expect_refused([](Motion& motion) { motion.map_slip[3] = -1e-4; });
  expect_refused([](Motion& motion) { motion.map_slip = {0.01, 0.02, 0.02, 0.01}; });  // not positive
  expect_refused([](Motion& motion) { motion.error_initial[2] = motion.error_initial[10] = 1.0; });
  expect_refused([](Motion& motion) { motion.error_noise[0] = std::numeric_limits<double>::quiet_NaN(); });
  expect_refused([](Motion& motion) { motion.error_transition[7] = 1e6; });
  expect_refused([](Motion& motion) {
    motion.alternative_count = 1;
    motion.alternatives[0].covariance[4] = 1e300;
  });
  expect_refused([](Motion& motion) {
    motion.alternative_count = 1;
    motion.alternatives[0].previous_T_current.x_m = 500.0;
  });
}

TEST_F(MotionGuardTest, WhatCameTwiceOrLateIsOldAndNotCounted) {
  begin();
  const Motion late = next();
  run(3);
  EXPECT_EQ(judge(late), MotionVerdict::kOld);
  EXPECT_EQ(judge(motion()), MotionVerdict::kOld);
  run(3);
  EXPECT_EQ(guard_.refused(), 0);
}

TEST_F(MotionGuardTest, FollowsASenderWhoseClockWasSet) {
  begin();
  run(10);
  for (const std::int64_t set_ns : {-kHour_ns, kHour_ns, -2 * kSecond}) {
    SCOPED_TRACE(set_ns);
    stamp_ns_ += set_ns;
    EXPECT_EQ(refused_before_one_is_taken(), MotionGuard::kAnewMotions - 1);
    EXPECT_EQ(verdict_, MotionVerdict::kContinues);
    EXPECT_EQ(guard_.arrived_after_ns(), MotionGuard::kAnewMotions * kGuardPeriod_ns);
    run(100);
  }
}

TEST_F(MotionGuardTest, TakesAMatcherThatWasStartedAnew) {
  begin();
  run(10);
  odom_T_scan_ = {};
  EXPECT_EQ(refused_before_one_is_taken(), MotionGuard::kAnewMotions - 1);
  EXPECT_EQ(verdict_, MotionVerdict::kBegins);
  run(100);
}

TEST_F(MotionGuardTest, OneForgedMotionThatCameFirstHoldsUpNobodyForLong) {
  Motion forged = next();
  forged.to_stamp_ns += 1000 * kHour_ns;
  EXPECT_EQ(judge(forged), MotionVerdict::kBegins);
  EXPECT_EQ(refused_before_one_is_taken(), MotionGuard::kAnewMotions - 1);
  run(100);
}

TEST_F(MotionGuardTest, ForgedOnesBetweenGoodOnesAreNeverTaken) {
  begin();
  for (int i = 1; i < 1000; ++i) {
    run(1);
    Motion forged = motion();
    forged.from_stamp_ns += kHour_ns + i;
    forged.to_stamp_ns += kHour_ns + i;
    EXPECT_EQ(judge(forged), MotionVerdict::kRefused);
    EXPECT_EQ(guard_.refused(), i);
  }
}

TEST_F(MotionGuardTest, ACarriedRobotIsBelievedAsSoonAsItCouldHaveGoneSoFar) {
  begin();
  run(10);
  odom_T_scan_ = Pose2{3.0, 0.0, 0.0} * odom_T_scan_;
  EXPECT_LE(refused_before_one_is_taken(), MotionGuard::kAnewMotions);
  run(100);
}

}  // namespace
}  // namespace odoless
