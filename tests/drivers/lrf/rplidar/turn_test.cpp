#include "drivers/lrf/rplidar/turn.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/base/rng.hpp"

namespace odoless::rplidar {
namespace {

constexpr std::int64_t kMs = 1'000'000;
constexpr double kRadPerDeg = std::numbers::pi / 180.0;

/// Range to the walls of a square room of 4 m by 4 m, from its middle.
double room_m(double angle_deg) {
  const double angle_rad = angle_deg * kRadPerDeg;
  return 2.0 / std::max(std::abs(std::cos(angle_rad)), std::abs(std::sin(angle_rad)));
}

/// Two turns of `points` points each; whether a turn was completed, which then is to be asked.
template <class Range>
bool turn_twice(Turn& turn, int points, const Range& range_m, double first_deg = 0.3) {
  bool complete = false;
  for (int i = 0; i <= 2 * points; ++i) {
    const double angle_deg = first_deg + 360.0 * i / points;
    const double wrapped_deg = angle_deg - 360.0 * std::floor(angle_deg / 360.0);
    complete =
        turn.add({.angle_deg = wrapped_deg, .range_m = range_m(wrapped_deg)}, i * 180 * kMs / points) || complete;
  }
  return complete;
}

TEST(RplidarTurn, GivesEvenBeamsWhateverTheNumberOfPoints) {
  for (const int points : {300, 361, 364, 720, 1450}) {
    Turn turn;
    ASSERT_TRUE(turn_twice(turn, points, room_m));
    EXPECT_TRUE(turn.is_whole());
    EXPECT_NEAR(static_cast<double>(turn.period_ns()), 180.0 * kMs, 1.0 * kMs);
    EXPECT_NEAR(static_cast<double>(turn.start_ns()), 180.0 * kMs - 0.3 / 360.0 * 180.0 * kMs, 0.01 * kMs);
    std::vector<float> ranges_m(360);
    EXPECT_EQ(turn.resample(ranges_m), 360);
    for (std::size_t i = 0; i < ranges_m.size(); ++i) {
      // In a corner, the line between two points cuts it off by a bit.
      EXPECT_NEAR(ranges_m[i], room_m(static_cast<double>(i)), i % 90 == 45 ? 0.03 : 0.001) << points << " " << i;
    }
  }
}

TEST(RplidarTurn, DoesNotMixSurfaces) {
  Turn turn;
  ASSERT_TRUE(turn_twice(turn, 361, [](double angle_deg) { return angle_deg < 100.5 ? 1.0 : 3.0; }));
  std::vector<float> ranges_m(360);
  EXPECT_EQ(turn.resample(ranges_m), 360);
  for (const float range_m : ranges_m) {
    EXPECT_TRUE(std::abs(range_m - 1.0F) < 1e-5F || std::abs(range_m - 3.0F) < 1e-5F) << range_m;
  }
}

TEST(RplidarTurn, TellsNoReturnFromNoPoint) {
  Turn turn;
  const auto range_m = [](double angle_deg) { return angle_deg > 50.0 && angle_deg < 60.0 ? 0.0 : 2.0; };
  for (int i = 0; i <= 2 * 720; ++i) {
    const double angle_deg = (i % 720) * 0.5;
    if (angle_deg < 200.0 || angle_deg > 210.0) {
      static_cast<void>(turn.add({.angle_deg = angle_deg, .range_m = range_m(angle_deg)}, i * kMs / 4));
    }
  }
  std::vector<float> ranges_m(360);
  EXPECT_EQ(turn.resample(ranges_m), 360 - 11);
  EXPECT_TRUE(std::isinf(ranges_m[55]));
  EXPECT_EQ(ranges_m[205], 0.0F);
  EXPECT_FLOAT_EQ(ranges_m[100], 2.0F);
}

TEST(RplidarTurn, TheFirstOneIsNotWholeAndBackwardsSpoils) {
  Turn turn;
  bool complete = false;
  for (double angle_deg = 123.0; angle_deg < 362.0; angle_deg += 1.0) {
    complete =
        complete || turn.add({.angle_deg = angle_deg < 360.0 ? angle_deg : angle_deg - 360.0, .range_m = 1.0}, 0);
  }
  EXPECT_TRUE(complete);
  EXPECT_FALSE(turn.is_whole());
  static_cast<void>(turn.add({.angle_deg = 100.0, .range_m = 1.0}, kMs));
  static_cast<void>(turn.add({.angle_deg = 20.0, .range_m = 1.0}, 2 * kMs));
  static_cast<void>(turn.add({.angle_deg = 180.0, .range_m = 1.0}, 2 * kMs));
  static_cast<void>(turn.add({.angle_deg = 300.0, .range_m = 1.0}, 2 * kMs));
  ASSERT_TRUE(turn.add({.angle_deg = 3.0, .range_m = 1.0}, 3 * kMs));
  EXPECT_TRUE(turn.is_whole());
  EXPECT_TRUE(turn.is_spoilt());
}

TEST(RplidarTurn, AMotorThatStandsStillFillsNoMemory) {
  Turn turn;
  for (int i = 0; i < 100'000; ++i) {
    EXPECT_FALSE(turn.add({.angle_deg = 100.0, .range_m = 1.0}, i * kMs));
  }
  EXPECT_TRUE(turn_twice(turn, 361, room_m));
  EXPECT_TRUE(turn.is_whole());
}

}  // namespace
}  // namespace odoless::rplidar
