// What every servo's axis does, over both protocols: near its limits, without torque, and slowly.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "tests/tools/servo_support.hpp"

namespace odoless {
namespace {

using test::kServoMs;
using test::kServoSecond;
using test::ServoBench;

class TiltAxis : public ::testing::TestWithParam<TiltDriver> {
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

INSTANTIATE_TEST_SUITE_P(Both, TiltAxis, ::testing::Values(TiltDriver::kCia402, TiltDriver::kDynamixel),
                         [](const auto& tested) {
                           return std::string(kTiltDriverNames[static_cast<std::size_t>(tested.param)]);
                         });

}  // namespace
}  // namespace odoless
