#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "tests/tools/sim_support.hpp"
#include "tools/sim/ray_caster.hpp"

namespace odoless {
namespace {

double distance_m(const Segment& segment, const Point2& p) {
  const double ex = segment.b.x_m - segment.a.x_m;
  const double ey = segment.b.y_m - segment.a.y_m;
  const double along = ((p.x_m - segment.a.x_m) * ex + (p.y_m - segment.a.y_m) * ey) / (ex * ex + ey * ey);
  const double share = std::clamp(along, 0.0, 1.0);
  return std::hypot(segment.a.x_m + share * ex - p.x_m, segment.a.y_m + share * ey - p.y_m);
}

double nearest_m(const World& world, const Point2& p) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const Segment& segment : world.segments) {
    nearest = std::min(nearest, distance_m(segment, p));
  }
  for (const Pillar& pillar : world.pillars) {
    const double to_rim = std::hypot(p.x_m - pillar.centre.x_m, p.y_m - pillar.centre.y_m) - pillar.radius_m;
    nearest = std::min(nearest, std::abs(to_rim));
  }
  return nearest;
}

/// Walks along the ray by the distance to the nearest surface, which can't step over one.
double march_m(const World& world, const Point2& origin, const Point2& direction, double end_m) {
  double range_m = 0.0;
  while (range_m < end_m) {
    const double free_m =
        nearest_m(world, {origin.x_m + range_m * direction.x_m, origin.y_m + range_m * direction.y_m});
    if (free_m < 1e-9) {
      return range_m;
    }
    range_m += free_m;
  }
  return std::numeric_limits<double>::infinity();
}

TEST(RayCaster, AgreesWithAMarchAlongTheRay) {
  constexpr double kBeyondM = 20.0;
  Rng rng(1);
  int hits = 0;
  for (int round = 0; round < 2000; ++round) {
    World world = test::random_world(rng);
    world.segments.resize(1 + rng.below(6));
    world.pillars.resize(1 + rng.below(4));
    const Point2 origin = test::random_point(rng, 6.0);
    const double angle_rad = rng.uniform(-4.0, 4.0);
    const Point2 direction{std::cos(angle_rad), std::sin(angle_rad)};
    const double range_m = cast_ray_m(world, origin, direction);
    const double marched_m = march_m(world, origin, direction, kBeyondM);
    ASSERT_EQ(std::isfinite(range_m), std::isfinite(marched_m)) << "round " << round;
    if (std::isfinite(range_m)) {
      ++hits;
      ASSERT_NEAR(range_m, marched_m, 1e-6) << "round " << round;
    }
  }
  EXPECT_GT(hits, 500);
  EXPECT_LT(hits, 1900);
}

TEST(RayCaster, LetsNoRaySlipThroughTheCornersOfARoom) {
  Rng rng(2);
  for (int round = 0; round < 300; ++round) {
    const Pose2 pose{rng.uniform(-9.0, 9.0), rng.uniform(-9.0, 9.0), rng.uniform(-3.0, 3.0)};
    const World world{.segments = rectangle(pose, 4.0, 3.0)};
    const Point2 origin = pose * Point2{rng.uniform(-1.9, 1.9), rng.uniform(-1.4, 1.4)};
    for (const Segment& side : world.segments) {
      const double x = side.a.x_m - origin.x_m;
      const double y = side.a.y_m - origin.y_m;
      const double length_m = std::hypot(x, y);
      ASSERT_NEAR(cast_ray_m(world, origin, {x / length_m, y / length_m}), length_m, 1e-6);
    }
  }
}

TEST(RayCaster, SeesAPillarFromInsideAndNotBehindItself) {
  const World world{.pillars = {{{1.0, 0.0}, 2.0}}};
  EXPECT_NEAR(cast_ray_m(world, {1.0, 0.0}, {0.0, 1.0}), 2.0, 1e-12);
  EXPECT_NEAR(cast_ray_m(world, {-4.0, 0.0}, {1.0, 0.0}), 3.0, 1e-12);
  EXPECT_TRUE(std::isinf(cast_ray_m(world, {-4.0, 0.0}, {-1.0, 0.0})));
}

TEST(RayCaster, DoorIsAGapOfItsWidth) {
  const Segment wall{{0.0, 0.0}, {10.0, 0.0}};
  const World world{.segments = without_disc(wall, {4.0, 0.0}, 0.5)};
  for (double x_m = 0.01; x_m < 10.0; x_m += 0.02) {
    EXPECT_EQ(std::isinf(cast_ray_m(world, {x_m, -1.0}, {0.0, 1.0})), x_m > 3.5 && x_m < 4.5) << "x " << x_m;
  }
}

TEST(RayCaster, DoorTakesNothingOfAWallThatItDoesNotReach) {
  const Segment wall{{0.0, 0.0}, {10.0, 0.0}};
  EXPECT_EQ(without_disc(wall, {4.0, 0.6}, 0.5).size(), 1U);
  EXPECT_EQ(without_disc(wall, {-0.6, 0.0}, 0.5)[0].a.x_m, 0.0);
  EXPECT_NEAR(without_disc(wall, {-0.2, 0.0}, 0.5)[0].a.x_m, 0.3, 1e-12);
  EXPECT_NEAR(without_disc(wall, {10.1, 0.0}, 0.5)[0].b.x_m, 9.6, 1e-12);
  EXPECT_TRUE(without_disc(wall, {5.0, 0.0}, 6.0).empty());
}

// To and fro along 3 m and 4 m at 1 m/s: out for 7 s, back for 7 s.
TEST(Walker, GoesToAndFroAtItsSpeed) {
  const Walker walker{0.25, 1.0, {{0.0, 0.0}, {3.0, 0.0}, {3.0, 4.0}}};
  const auto expect_at = [&](double time_s, double x_m, double y_m) {
    const Pillar body = at_time(walker, time_s);
    EXPECT_NEAR(body.centre.x_m, x_m, 1e-9) << time_s;
    EXPECT_NEAR(body.centre.y_m, y_m, 1e-9) << time_s;
    EXPECT_EQ(body.radius_m, 0.25);
  };
  expect_at(-1.0, 0.0, 0.0);
  expect_at(2.0, 2.0, 0.0);
  expect_at(5.0, 3.0, 2.0);
  expect_at(7.0, 3.0, 4.0);
  expect_at(9.0, 3.0, 2.0);
  expect_at(13.0, 1.0, 0.0);
  expect_at(14.0 + 2.0, 2.0, 0.0);
}

TEST(RayCaster, SeesWalkersWhereTheyAreAtTheTime) {
  World world;
  world.walkers = {{0.5, 1.0, {{4.0, -2.0}, {4.0, 2.0}}}};
  EXPECT_NEAR(cast_ray_m(world, 2.0, {0.0, 0.0}, {1.0, 0.0}), 3.5, 1e-9);
  EXPECT_TRUE(std::isinf(cast_ray_m(world, 0.0, {0.0, 0.0}, {1.0, 0.0})));
  EXPECT_TRUE(std::isinf(cast_ray_m(world, {0.0, 0.0}, {1.0, 0.0}))) << "without a time there are none";
}

TEST(RayCaster, WalkersStepAsideOfTheRobot) {
  World world;
  world.walkers = {{0.25, 1.0, {{0.2, -2.0}, {0.2, 2.0}}}};
  EXPECT_NEAR(cast_ray_m(world, 2.0, {0.0, 0.0}, {1.0, 0.0}), kAside_m - 0.25, 1e-9);
  EXPECT_NEAR(cast_ray_m(world, 2.0, {-5.0, 0.0}, {1.0, 0.0}), 4.95, 1e-9);
}

}  // namespace
}  // namespace odoless
