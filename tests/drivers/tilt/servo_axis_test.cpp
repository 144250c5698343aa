// What every servo's axis does, over both protocols: near its limits, without torque, and slowly.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "tests/support/servo_support.hpp"

namespace odoless {
namespace {

using test::kServoMs;
using test::kServoSecond;
using test::ServoBench;

constexpr double kAxisStepRad = 0.0016;  ///< 4096 steps per turn

class TiltAxis : public ::testing::TestWithParam<test::TestedServo> {
 protected:
  [[nodiscard]] static TiltParams params(TiltCommand at_start = TiltCommand::kLevel) {
    TiltParams params = test::servo_params(GetParam());
    params.at_start = at_start;
    return params;
  }
};

TEST_P(TiltAxis, AnAxisThatRestsOutsideTheLimitsComesUpAndGoesInside) {
  for (const double start_rad : {-1.2, 0.9}) {
    ServoBench bench(params(), ServoBench::make_servo(params(), {}, {.start_rad = start_rad}));
    bench.reset();
    EXPECT_GT(bench.run_until(TiltState::kLevel, 3 * kServoSecond), 0) << "from " << start_rad;
    EXPECT_EQ(bench.heard().events.size(), 1U) << "it is ready, and nothing is wrong";
    ServoBench stopped(params(TiltCommand::kStop), ServoBench::make_servo(params(), {}, {.start_rad = start_rad}));
    stopped.reset();
    EXPECT_GT(stopped.run_until(TiltState::kStopped, kServoSecond), 0) << "from " << start_rad;
    stopped.run(kServoSecond);
    EXPECT_EQ(stopped.session().state(), TiltState::kStopped);
    EXPECT_EQ(stopped.heard().events.size(), 1U);
  }
}

TEST_P(TiltAxis, TheAxisSinksNotWhileTheLineIsLostAndComesBack) {
  for (const TiltCommand command : {TiltCommand::kStop, TiltCommand::kLevel}) {
    for (const std::int64_t lost_ms : {200, 500, 1500, 4000}) {
      SCOPED_TRACE(testing::Message() << kTiltCommandNames[static_cast<std::size_t>(command)] << ", " << lost_ms);
      ServoBench bench(params(), ServoBench::make_servo(params(), {}, {.droop_radps = 1.0}));
      bench.reset();
      ASSERT_GT(bench.run_until(TiltState::kLevel, 5 * kServoSecond), 0);
      bench.run(kServoSecond);
      bench.command(command);
      bench.run(kServoSecond);
      const TiltState held = bench.session().state();
      const std::size_t first = bench.truth().size();
      bench.to_session = bench.to_servo = [](std::vector<ServoFrame>& frames) { frames.clear(); };
      bench.run(lost_ms * kServoMs);
      bench.to_session = bench.to_servo = [](std::vector<ServoFrame>&) {};
      bench.run(3 * kServoSecond);
      EXPECT_EQ(bench.session().state(), held);
      for (std::size_t i = first; i < bench.truth().size(); ++i) {
        ASSERT_NEAR(bench.truth()[i].angle_rad, 0.0, kAxisStepRad);
      }
    }
  }
}

// The slowest that the configuration takes, and some between these and the default.
TEST_P(TiltAxis, SlowOrGentleMotionIsNoStallAndARealOneIsToldAllTheSame) {
  struct Motion {
    double speed_radps;
    double acceleration_radps2;
    double end_rad;
  };
  const TiltParams usual = params();
  for (const Motion& motion : {Motion{0.01, usual.acceleration_radps2, 0.03}, Motion{0.01, 0.1, 0.03},
                               Motion{0.0357, usual.acceleration_radps2, 0.1}, Motion{usual.speed_radps, 0.1, 0.3},
                               Motion{20.0, 0.1, 0.3}, Motion{usual.speed_radps, 0.56, 0.3},
                               Motion{usual.speed_radps, 1.5, 0.3}, Motion{usual.speed_radps, 3.0, 0.3}}) {
    SCOPED_TRACE(testing::Message() << motion.speed_radps << " rad/s, " << motion.acceleration_radps2 << " rad/s2");
    TiltParams slow = params(TiltCommand::kSweep);
    slow.speed_radps = motion.speed_radps;
    slow.acceleration_radps2 = motion.acceleration_radps2;
    slow.sweep_from_rad = -motion.end_rad;
    slow.sweep_to_rad = motion.end_rad;
    ServoBench bench(slow, ServoBench::make_servo(slow, {parse_fault("stall@30")}, {.start_rad = 0.0}));
    bench.reset();
    bench.run(29'900 * kServoMs);
    double low_rad = 0.0;
    double high_rad = 0.0;
    for (const TiltSample& sample : bench.heard().samples) {
      low_rad = std::min(low_rad, sample.angle_rad);
      high_rad = std::max(high_rad, sample.angle_rad);
    }
    EXPECT_LT(low_rad, 0.01 - motion.end_rad) << "it has been at both ends";
    EXPECT_GT(high_rad, motion.end_rad - 0.01);
    EXPECT_EQ(bench.session().counters().stalls, 0U);
    EXPECT_EQ(bench.heard().count(TiltEventType::kLost), 0);
    bench.run(100 * kServoMs);
    EXPECT_GE(bench.run_until(TiltState::kFault, 1600 * kServoMs), 0);
    EXPECT_EQ(bench.session().counters().stalls, 1U);
  }
}

// From one sample to the next it moves by a third of a radian.
TEST_P(TiltAxis, AQuickServoThatIsAskedRarelyIsBelieved) {
  TiltParams quick = params(TiltCommand::kSweep);
  quick.speed_radps = 6.0;
  quick.acceleration_radps2 = 200.0;
  quick.sample_period_ns = 60 * kServoMs;
  ServoBench bench(quick);
  bench.reset();
  ASSERT_GE(bench.run_until(TiltState::kSweeping, 3 * kServoSecond), 0);
  bench.run(5 * kServoSecond);
  EXPECT_EQ(bench.session().counters().implausible, 0U);
  EXPECT_EQ(bench.session().counters().restarts, 0U);
  EXPECT_GT(bench.heard().samples.size(), 70U);
}

INSTANTIATE_TEST_SUITE_P(Servos, TiltAxis, ::testing::ValuesIn(test::kTestedServos),
                         [](const auto& tested) { return std::string(tested.param.name); });

}  // namespace
}  // namespace odoless
