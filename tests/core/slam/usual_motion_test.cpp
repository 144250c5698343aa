#include "core/slam/usual_motion.hpp"

#include <gtest/gtest.h>

namespace odoless {
namespace {

UsualMotion after(int steps, const Pose2& step) {
  UsualMotion usual{TrackingParams{}};
  for (int i = 0; i < steps; ++i) {
    usual.add(step);
  }
  return usual;
}

TEST(UsualMotion, ARobotThatIsCarriedAwayMovesUnlikeBefore) {
  const UsualMotion usual = after(100, {0.1, 0.0, 0.1});
  EXPECT_TRUE(usual.is_dense());
  EXPECT_FALSE(usual.is_unusual({0.2, 0.0, -0.2}));
  EXPECT_TRUE(usual.is_unusual({3.0, 0.0, 0.0}));
  EXPECT_TRUE(usual.is_unusual({0.0, 0.0, -1.5}));
}

TEST(UsualMotion, WhereScansAreFarApartFarStepsAreUsual) {
  const UsualMotion usual = after(5, {1.5, 0.0, 0.8});
  EXPECT_FALSE(usual.is_dense());
  EXPECT_FALSE(usual.is_unusual({3.0, 0.0, 1.5}));
}

TEST(UsualMotion, ForgetsOneFarStep) {
  UsualMotion usual = after(1, {1.0, 0.0, 0.0});
  EXPECT_FALSE(usual.is_dense());
  for (int i = 0; i < 100; ++i) {
    usual.add({0.1, 0.0, 0.0});
  }
  EXPECT_TRUE(usual.is_dense());
}

TEST(UsualMotion, IsTooFastByTheTimeThatAStepTook) {
  const UsualMotion usual{TrackingParams{}};
  EXPECT_TRUE(usual.is_too_fast({2.0, 0.0, 0.0}, 0.1));
  EXPECT_FALSE(usual.is_too_fast({2.0, 0.0, 0.0}, 1.0));
  EXPECT_TRUE(usual.is_too_fast({0.0, 0.0, 1.0}, 0.1));
}

}  // namespace
}  // namespace odoless
