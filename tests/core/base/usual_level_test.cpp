#include "core/base/usual_level.hpp"

#include <gtest/gtest.h>

namespace odoless {
namespace {

constexpr double kMemory_s = 5.0;

TEST(UsualLevel, NothingIsUsualBeforeItWasSeenForAWhile) {
  UsualLevel level(kMemory_s);
  EXPECT_EQ(level.value(), 0.0);
  for (int i = 0; i < 49; ++i) {
    level.add(0.8, 0.1);
    ASSERT_EQ(level.value(), 0.0);
  }
  level.add(0.8, 0.2);
  EXPECT_NEAR(level.value(), 0.8, 1e-12);
}

TEST(UsualLevel, OneOddValueMovesItLittleAndManyMoveItThere) {
  UsualLevel level(kMemory_s);
  level.add(0.8, 5.0);
  level.add(0.0, 0.1);
  EXPECT_GT(level.value(), 0.75);
  for (int i = 0; i < 200; ++i) {
    level.add(0.2, 0.1);
  }
  EXPECT_NEAR(level.value(), 0.2, 0.02);
}

TEST(UsualLevel, CountsValuesByTheirTimeAndNotByTheirNumber) {
  UsualLevel often(kMemory_s);
  UsualLevel rarely(kMemory_s);
  often.add(1.0, 5.0);
  rarely.add(1.0, 5.0);
  for (int i = 0; i < 100; ++i) {
    often.add(0.0, 0.01);
  }
  rarely.add(0.0, 1.0);
  EXPECT_NEAR(often.value(), rarely.value(), 0.03);
  rarely.add(0.5, 100.0);
  EXPECT_EQ(rarely.value(), 0.5) << "never beyond the value itself";
}

}  // namespace
}  // namespace odoless
