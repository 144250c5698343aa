#include "core/slam/recovery.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/slam/scan_fit.hpp"
#include "tests/support/simulated_room.hpp"

namespace odoless {
namespace {

constexpr int kBeamsOfRoom = 120;
constexpr ScanParams kRecoveryScan{.beams_max = kBeamsOfRoom, .range_max_m = 20.0};

SlamParams small_slam() {
  SlamParams params;
  params.low.particles = 50;
  params.low.grid = {.resolution_m = 0.1, .width_m = 8.0, .height_m = 8.0, .tiles_max = 8000};
  params.high.particles = 0;
  return params;
}

/// A filter that has mapped the room, each scan of it seen by the recovery first; and the recovery's figures, anew.
class RecoveryTest : public ::testing::Test {
 protected:
  RecoveryTest()
      : slam_(small_slam(), kRecoveryScan, 5), room_(4, kBeamsOfRoom), recovery_(params_, kRecoveryScan, slam_) {
    for (int i = 0; i < 2 * params_.tracking.updates_min; ++i) {
      room_.step();
      EXPECT_TRUE(i == 0 || advice() == Advice::kGoOn) << i;
      static_cast<void>(slam_.update(room_.motion(), room_.scan()));
      recovery_.note_update(1.0);
    }
    room_.step();
  }

  Advice advice() {
    const Motion motion = room_.motion();
    return recovery_.process(slam_,
                             {.scan = room_.scan(), .update_T_scan = motion.previous_T_current, .motion = motion});
  }

  double fit_of(int particle) {
    Lslam& low = slam_.low();
    ScanFit fit(low.params().beam, params_.tracking.fit_sigma_m, low.geometry().resolution_m, low.params().beams_used);
    EXPECT_GT(fit.load(room_.scan()), 0);
    return fit.of(low.map(particle), low.geometry(), low.pose(particle) * room_.motion().previous_T_current);
  }

  double best_fit() {
    double best = 0.0;
    for (int particle = 0; particle < slam_.particles(); ++particle) {
      best = std::max(best, fit_of(particle));
    }
    return best;
  }

  RecoveryParams params_;
  Slam slam_;
  SimulatedRoom room_;
  Recovery recovery_;
};

TEST_F(RecoveryTest, TakesTheBestParticlesFitWhereThatIsGood) {
  EXPECT_EQ(advice(), Advice::kGoOn);
  EXPECT_EQ(recovery_.fit(), fit_of(slam_.low().best()));
  EXPECT_GT(recovery_.fit(), 0.7);
}

// As at a loop: which particle is right is for the filter to decide, and for that it needs the scan.
TEST_F(RecoveryTest, LeavesTheScanToAFilterWhoseBestParticleAloneIsWrong) {
  slam_.set_pose(slam_.map_T_scan(), {.sd_m = 0.7, .sd_rad = 0.5});
  ASSERT_LT(fit_of(slam_.low().best()), params_.tracking.fit_min);
  ASSERT_GT(best_fit(), 2.0 * params_.tracking.fit_min);
  EXPECT_EQ(advice(), Advice::kGoOn);
  EXPECT_EQ(recovery_.fit(), best_fit());
}

TEST_F(RecoveryTest, HoldsAScanThatFitsNoParticle) {
  const Pose2 wrong = slam_.map_T_scan() * Pose2{1.5, 1.0, 0.9};
  slam_.set_pose(wrong);
  ASSERT_LT(best_fit(), params_.tracking.fit_min);
  EXPECT_EQ(advice(), Advice::kHold);
  EXPECT_EQ(recovery_.fit(), best_fit());
}

TEST_F(RecoveryTest, IsSureUntilAStepIsNotCredible) {
  EXPECT_EQ(advice(), Advice::kGoOn);
  EXPECT_EQ(recovery_.state(), Tracking::kSure);
  EXPECT_GT(recovery_.probability(), 0.98);
  Motion motion = room_.motion();
  motion.probability = 0.6;
  static_cast<void>(
      recovery_.process(slam_, {.scan = room_.scan(), .update_T_scan = motion.previous_T_current, .motion = motion}));
  EXPECT_EQ(recovery_.state(), Tracking::kDoubtful);
  EXPECT_LT(recovery_.probability(), 0.7);
}

TEST_F(RecoveryTest, IsLostAfterAStepThatIsSurelyWrongAndMapsNothing) {
  Motion motion = room_.motion();
  motion.probability = 0.05;
  EXPECT_EQ(
      recovery_.process(slam_, {.scan = room_.scan(), .update_T_scan = motion.previous_T_current, .motion = motion}),
      Advice::kHold);
  EXPECT_EQ(recovery_.state(), Tracking::kLost);
  EXPECT_EQ(recovery_.probability(), 0.0);
}

// As at the end of a long loop, where the map has drifted: it lacks the right place, and may have a twin of it.
TEST_F(RecoveryTest, BelievesInAnotherPlaceOnlyWhereAStepMayHaveBeenWrong) {
  params_.search.rival_ratio = 1.0;  // the room has a twin for few beams
  for (const double probability : {1.0, 0.98}) {
    Slam slam = slam_;
    SimulatedRoom room = room_;
    Recovery recovery(params_, kRecoveryScan, slam);
    const auto take = [&](const Motion& motion) {
      static_cast<void>(
          recovery.process(slam, {.scan = room.scan(), .update_T_scan = motion.previous_T_current, .motion = motion}));
    };
    for (int i = 0; i < 100; ++i, room.step()) {
      take(room.motion());
      static_cast<void>(slam.update(room.motion(), room.scan()));
      recovery.note_update(1.0);
    }
    ASSERT_EQ(recovery.state(), Tracking::kSure);
    slam.set_pose(slam.map_T_scan() * Pose2{1.5, 1.0, 0.9});
    bool was_lost = false;
    for (int i = 0; i < 300; ++i, room.step()) {
      Motion motion = room.motion();
      motion.probability = i == 0 ? probability : 1.0;
      motion.set(kJolted, true);  // so that another place is looked for
      take(motion);
      was_lost = was_lost || recovery.lost();
    }
    EXPECT_EQ(was_lost, probability < 1.0);
    EXPECT_NE(recovery.state(), Tracking::kSure);
  }
}

TEST_F(RecoveryTest, TellsHowLongNobodyKnewWhereTheRobotWas) {
  params_.search.rival_ratio = 1.0;  // the room has a twin for few beams
  Recovery recovery(params_, kRecoveryScan, slam_);
  for (int i = 0; i < params_.tracking.updates_min; ++i) {
    recovery.note_update(1.0);
  }
  Motion motion = room_.motion();
  const auto take = [&] {
    return recovery.process(slam_,
                            {.scan = room_.scan(), .update_T_scan = motion.previous_T_current, .motion = motion});
  };
  motion.probability = 0.6;
  static_cast<void>(take());
  EXPECT_EQ(recovery.unknown_s(), 0.0) << "it may be right";
  motion.probability = 0.05;
  static_cast<void>(take());
  ASSERT_TRUE(recovery.lost());
  EXPECT_EQ(recovery.unknown_s(), 0.0) << "the scans match each other yet";
  double unsure_s = 2.0 * motion.duration_s();
  Advice advice = Advice::kHold;
  while (advice == Advice::kHold && unsure_s < 15.0) {
    room_.step();
    motion = room_.motion();
    unsure_s += motion.duration_s();
    advice = take();
    EXPECT_NEAR(recovery.unknown_s(), advice == Advice::kFound ? unsure_s : 0.0, 1e-9);
  }
  EXPECT_EQ(advice, Advice::kFound);
}

TEST_F(RecoveryTest, IsNotSureWhereTheParticlesDoNotAgree) {
  EXPECT_EQ(recovery_.state(0.5), Tracking::kDoubtful);
  EXPECT_EQ(recovery_.state(1.0), Tracking::kSure);
}

}  // namespace
}  // namespace odoless
