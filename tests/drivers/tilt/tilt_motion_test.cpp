#include "drivers/tilt/tilt_motion.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "drivers/tilt/angle_gate.hpp"
#include "tests/support/times.hpp"

namespace odoless {
namespace {

using test::kMs;

TiltSample at(std::int64_t stamp_ns, double angle_rad) {
  return {.stamp_ns = stamp_ns, .arrival_ns = stamp_ns, .angle_rad = angle_rad};
}

TEST(TiltMotion, GoesForTheLevelPoseAndSaysWhenItIsThere) {
  TiltMotion motion({});
  motion.start(0);
  EXPECT_EQ(motion.target_rad(), 0.0);
  EXPECT_EQ(motion.state(), TiltState::kMoving) << "nothing is known yet";
  motion.on_angle(at(1, 0.2));
  EXPECT_EQ(motion.state(), TiltState::kMoving);
  motion.on_angle(at(2, 0.005));
  EXPECT_EQ(motion.state(), TiltState::kLevel);
  motion.on_angle(at(3, 0.05));
  EXPECT_EQ(motion.state(), TiltState::kMoving) << "pushed away";
}

TEST(TiltMotion, TurnsASweepRoundAtItsEnds) {
  TiltParams params;
  params.at_start = TiltCommand::kSweep;
  params.sweep_from_rad = -0.3;
  params.sweep_to_rad = 0.4;
  TiltMotion motion(params);
  motion.start(0);
  EXPECT_EQ(motion.target_rad(), 0.4);
  motion.on_angle(at(1, 0.39));
  EXPECT_EQ(motion.target_rad(), 0.4) << "not yet within the tolerance";
  motion.on_angle(at(2, 0.395));
  EXPECT_EQ(motion.target_rad(), -0.3);
  motion.on_angle(at(3, 0.4));
  EXPECT_EQ(motion.target_rad(), -0.3);
  motion.on_angle(at(4, -0.296));
  EXPECT_EQ(motion.target_rad(), 0.4);
}

TEST(TiltMotion, KeepsASweepWithinTheLimits) {
  TiltParams params;
  params.at_start = TiltCommand::kSweep;
  params.limit_max_rad = 0.1;
  params.sweep_from_rad = 3.0;  // both ends are cut to the same: no sweep, but no harm
  params.sweep_to_rad = 2.0;
  TiltMotion motion(params);
  for (int i = 0; i < 10; ++i) {
    motion.on_angle(at(i, 0.1));
    EXPECT_EQ(motion.target_rad(), 0.1);
  }
}

TEST(TiltMotion, FindsAStallAfterItsTimeAndNotBefore) {
  TiltParams params;
  params.stall_timeout_ns = 150 * kMs;
  TiltMotion motion(params);
  motion.start(0);
  motion.on_angle(at(0, 0.3));
  for (std::int64_t now_ms = 0; now_ms < 100; now_ms += 10) {  // 0.01 rad per 10 ms: it moves
    motion.on_angle(at(now_ms * kMs, 0.3 - 0.001 * static_cast<double>(now_ms)));
    EXPECT_FALSE(motion.is_stalled(now_ms * kMs));
  }
  for (std::int64_t now_ms = 100; now_ms < 240; now_ms += 10) {  // noise, but no movement
    motion.on_angle(at(now_ms * kMs, 0.21 + (now_ms % 20 == 0 ? 0.001 : 0.0)));
    EXPECT_FALSE(motion.is_stalled(now_ms * kMs)) << now_ms;
  }
  EXPECT_TRUE(motion.is_stalled(251 * kMs));
  motion.command(TiltCommand::kStop, 251 * kMs);
  EXPECT_FALSE(motion.is_stalled(1000 * kMs)) << "what shall stand cannot stall";
}

TEST(TiltMotion, AServoThatTremblesButNeverArrivesIsStalledToo) {
  TiltMotion motion({});
  motion.start(0);
  bool stalled = false;
  for (std::int64_t now_ms = 0; now_ms < 5000 && !stalled; now_ms += 10) {
    motion.on_angle(at(now_ms * kMs, now_ms % 20 == 0 ? 0.30 : 0.31));
    stalled = motion.is_stalled(now_ms * kMs);
  }
  EXPECT_TRUE(stalled);
}

TEST(TiltMotion, AServoThatIsThereIsNotStalled) {
  TiltMotion motion({});
  motion.start(0);
  motion.on_angle(at(0, 0.001));
  EXPECT_FALSE(motion.is_stalled(3'600'000 * kMs));
}

TEST(TiltScale, GoesThereAndBack) {
  for (const bool inverted : {false, true}) {
    TiltParams params;
    params.inverted = inverted;
    params.level_angle_rad = 0.5;
    const TiltScale scale(params, 4096.0, 2048.0);
    EXPECT_EQ(scale.position_counts(0.0), 2048 + 326);  // 0.5 rad of 4096 per turn
    for (int counts = 0; counts < 4096; ++counts) {
      ASSERT_EQ(scale.position_counts(scale.angle_rad(counts)), counts);
    }
    EXPECT_GT(scale.velocity_radps(100.0) * (inverted ? -1.0 : 1.0), 0.0);
    EXPECT_GT((scale.angle_rad(3000) - scale.angle_rad(2000)) * (inverted ? -1.0 : 1.0), 0.0);
  }
  TiltParams params;
  const TiltScale fine(params, 1e12, 0.0);
  EXPECT_EQ(fine.position_counts(3.0), std::numeric_limits<std::int32_t>::max()) << "no overflow";
}

TEST(AngleGate, RefusesJumpsButBelievesThemWhenTheyStay) {
  AngleGate gate(2.0);
  EXPECT_TRUE(gate.passes(0, 0.1));
  EXPECT_TRUE(gate.passes(10 * kMs, 0.12));
  EXPECT_FALSE(gate.passes(20 * kMs, 1.5)) << "140 rad/s";
  EXPECT_TRUE(gate.passes(30 * kMs, 0.14)) << "one wrong angle costs itself alone";
  for (int i = 0; i < 4; ++i) {
    EXPECT_FALSE(gate.passes((40 + 10 * i) * kMs, 1.5));
  }
  EXPECT_TRUE(gate.passes(80 * kMs, 1.5));
  EXPECT_TRUE(gate.passes(90 * kMs, 1.51));
  gate.restart();
  EXPECT_TRUE(gate.passes(91 * kMs, -1.5));
}

TEST(AngleGate, WildAnglesAreNeverBelieved) {
  AngleGate gate(2.0);
  EXPECT_TRUE(gate.passes(0, 0.0));
  for (int i = 1; i < 100; ++i) {
    EXPECT_FALSE(gate.passes(i * 10 * kMs, i % 2 == 0 ? 3.0 : -3.0));
  }
}

}  // namespace
}  // namespace odoless
