#include "core/motion/travel_speed.hpp"

#include <gtest/gtest.h>

namespace odoless {
namespace {

Motion step(double x_m, double y_m, std::int64_t duration_ns) {
  return Motion::between(1'000, 1'000 + duration_ns, {x_m, y_m, 0.0});
}

TEST(TravelSpeed, PromisesNothingBeforeTheFirstDisplacement) {
  EXPECT_EQ(TravelSpeed().lambda_m(step(1.0, 0.0, 1'000'000'000)), 0.0);
}

TEST(TravelSpeed, PromisesTheSpeedOfTheLastTwoDisplacementsForTheTimeOfTheStep) {
  TravelSpeed speed;
  speed.add(step(9.0, 0.0, 100'000'000));
  speed.add(step(0.3, 0.4, 500'000'000));
  speed.add(step(-1.0, 0.0, 500'000'000));
  EXPECT_NEAR(speed.lambda_m(step(0.0, 0.0, 200'000'000)), (0.5 + 1.0) / 1.0 * 0.2, 1e-12);
}

TEST(TravelSpeed, LearnsNothingFromStampsThatDoNotAdvance) {
  TravelSpeed speed;
  speed.add(step(0.5, 0.0, 1'000'000'000));
  speed.add(step(7.0, 0.0, 0));
  speed.add(step(7.0, 0.0, -5));
  EXPECT_NEAR(speed.lambda_m(step(0.0, 0.0, 1'000'000'000)), 0.5, 1e-12);
  EXPECT_EQ(speed.lambda_m(step(0.0, 0.0, -5)), 0.0);
}

TEST(TravelSpeed, ForgetsOnReset) {
  TravelSpeed speed;
  speed.add(step(0.5, 0.0, 1'000'000'000));
  speed.reset();
  EXPECT_EQ(speed.lambda_m(step(0.0, 0.0, 1'000'000'000)), 0.0);
}

}  // namespace
}  // namespace odoless
