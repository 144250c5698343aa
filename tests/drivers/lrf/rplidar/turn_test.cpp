#include "drivers/lrf/rplidar/turn.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/base/rng.hpp"
#include "tests/support/times.hpp"

namespace odoless::rplidar {
namespace {

using test::kMs;
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

// The first turn has some points more, up to the front, and sees what is 5 m away; all others see 2 m.
TEST(RplidarTurn, NothingOfALongerTurnBeforeTheLastIsLeft) {
  for (const int more : {1, 2, 3, 4, 5}) {
    Turn turn;
    std::vector<float> ranges_m(360);
    std::int64_t now_ns = 0;
    for (int round = 0; round < 6; ++round) {
      const int points = round == 0 ? 300 + more : 300;
      const double last_deg = round == 0 ? 359.7 : 358.5;
      for (int i = 0; i < points; ++i, now_ns += kMs / 2) {
        const double angle_deg = 0.9 + (last_deg - 0.9) * i / (points - 1);
        if (turn.add({.angle_deg = angle_deg, .range_m = round == 0 ? 5.0 : 2.0}, now_ns) && round > 2) {
          EXPECT_EQ(turn.resample(ranges_m), 358) << "none where the last point of a turn is far from the first";
          EXPECT_EQ(std::ranges::count(ranges_m, 0.0F), 2);
          EXPECT_TRUE(std::ranges::none_of(ranges_m, [](float range_m) { return range_m > 2.001F; }));
        }
      }
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

/// As the device sends it: 7 degrees behind the mirror far away, less near it, and where nothing answered, none.
Point device_point(double mirror_deg, double range_m) {
  const double angle_deg = mirror_deg - (range_m > 0.0 ? 7.0 - 1.0 / range_m : 0.0);
  return {.angle_deg = angle_deg - 360.0 * std::floor(angle_deg / 360.0), .range_m = range_m};
}

/// Three turns of a sample per degree, each seeing `range_m` of the direction in which a far point lies.
template <class Range>
std::vector<float> ranges_of_device(const Range& range_m) {
  Turn turn;
  std::vector<float> ranges_m(360);
  for (int i = 0; i <= 3 * 361; ++i) {
    const double far_deg = i * 360.0 / 361 + 0.3;
    const double wrapped_deg = far_deg - 360.0 * std::floor(far_deg / 360.0);
    if (turn.add(device_point(far_deg + 7.0, range_m(wrapped_deg)), i * kMs / 2) && turn.is_whole()) {
      EXPECT_FALSE(turn.is_spoilt());
      EXPECT_EQ(turn.resample(ranges_m), 360) << "of each beam, something is known";
    }
  }
  return ranges_m;
}

// Its first and last beam may be either.
TEST(RplidarTurn, NoReturnIsWhereItsNeighboursLeaveRoom) {
  for (const int from_deg : {100, 330}) {  // the latter: across the front
    const auto since_deg = [=](double angle_deg) { return std::fmod(angle_deg - from_deg + 360.0, 360.0); };
    const std::vector<float> ranges_m =
        ranges_of_device([&](double angle_deg) { return since_deg(angle_deg) < 50.0 ? 0.0 : 2.0; });
    for (int beam = 0; beam < 360; ++beam) {
      const double beam_deg = since_deg(beam);  // a point at 2 m lies half a degree further than a far one
      if (beam_deg > 1.5 && beam_deg < 49.0) {
        EXPECT_TRUE(std::isinf(ranges_m[static_cast<std::size_t>(beam)])) << beam;
      } else if (beam_deg > 51.5) {
        EXPECT_FLOAT_EQ(ranges_m[static_cast<std::size_t>(beam)], 2.0F) << beam;
      }
    }
  }
}

TEST(RplidarTurn, SinglePointsWithoutAReturnLeaveTheWallsBesideThem) {
  int sample = 0;
  const std::vector<float> ranges_m = ranges_of_device([&](double) { return ++sample % 10 == 0 ? 0.0 : 2.0; });
  EXPECT_NEAR(static_cast<double>(std::count(ranges_m.begin(), ranges_m.end(), 2.0F)), 324.0, 3.0);
}

TEST(RplidarTurn, WhatWasLostAmongSamplesWithoutAReturnIsNotFree) {
  Turn turn;
  std::vector<float> ranges_m(360);
  for (int i = 0; i <= 721; ++i) {
    const int at_deg = i % 360;
    if (at_deg > 120 && at_deg < 145) {
      continue;
    }
    const double range_m = at_deg > 90 && at_deg < 150 ? 0.0 : 2.0;
    if (turn.add(device_point(at_deg + 7.25, range_m), i * kMs / 2)) {
      static_cast<void>(turn.resample(ranges_m));
    }
  }
  EXPECT_EQ(ranges_m[135], 0.0F);
  EXPECT_FLOAT_EQ(ranges_m[80], 2.0F);
}

TEST(RplidarTurn, WhereNothingAnswersEveryBeamIsFree) {
  for (const float range_m : ranges_of_device([](double) { return 0.0; })) {
    EXPECT_TRUE(std::isinf(range_m));
  }
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
