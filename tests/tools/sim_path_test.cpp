#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/tools/sim_support.hpp"
#include "tools/sim/path.hpp"

namespace odoless {
namespace {

double nearest_approach_m(const Path& path, const Point2& point) {
  constexpr double kStepS = 1e-3;
  double nearest = 1e9;
  for (double time_s = 0.0; time_s < path.duration_s() + kStepS; time_s += kStepS) {
    const Pose2 pose = path.at(time_s);
    nearest = std::min(nearest, std::hypot(pose.x_m - point.x_m, pose.y_m - point.y_m));
  }
  return nearest;
}

TEST(Path, KeepsSpeedAndTurnRateWithinTheirBounds) {
  constexpr double kStepS = 0.01;
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    Rng rng(seed);
    std::vector<Waypoint> waypoints = test::random_world(rng).waypoints;
    double speed_mps = 0.0;
    double turn_rate_radps = 0.0;
    for (const Waypoint& waypoint : waypoints) {
      speed_mps = std::max(speed_mps, waypoint.speed_mps);
      turn_rate_radps = std::max(turn_rate_radps, waypoint.turn_rate_radps);
    }
    const Path path(waypoints);
    for (double time_s = 0.0; time_s < path.duration_s(); time_s += kStepS) {
      const Pose2 before = path.at(time_s);
      const Pose2 after = path.at(time_s + kStepS);
      ASSERT_LE(after.distance_m(before), speed_mps * kStepS + 1e-9) << "seed " << seed << " at " << time_s;
      ASSERT_LE(std::abs(wrap_angle(after.yaw_rad - before.yaw_rad)), turn_rate_radps * kStepS + 1e-9)
          << "seed " << seed << " at " << time_s;
    }
  }
}

TEST(Path, EachLegHasItsOwnBounds) {
  const std::vector<Waypoint> waypoints{
      {.position = {0.0, 0.0}},
      {.position = {4.0, 0.0}, .speed_mps = 2.0},
      {.position = {4.0, 3.0}, .speed_mps = 0.5, .turn_rate_radps = 1.0, .corner_radius_m = 0.0}};
  const Path path(waypoints);
  EXPECT_NEAR(path.duration_s(), 2.0 + std::numbers::pi / 2.0 + 6.0, 1e-9);
  EXPECT_NEAR(path.length_m(), 7.0, 1e-9);
  EXPECT_NEAR(path.at(1.0).x_m, 2.0, 1e-9);
  EXPECT_NEAR(path.at(2.5).yaw_rad, 0.5, 1e-9);
  EXPECT_NEAR(path.at(2.0 + std::numbers::pi / 2.0 + 1.0).y_m, 0.5, 1e-9);
}

TEST(Path, RunsThroughEveryWayPointWhereCornersAreSharp) {
  Rng rng(3);
  std::vector<Waypoint> waypoints = test::random_world(rng).waypoints;
  for (Waypoint& waypoint : waypoints) {
    waypoint.corner_radius_m = 0.0;
  }
  const Path path(waypoints);
  for (const Waypoint& waypoint : waypoints) {
    EXPECT_LT(nearest_approach_m(path, waypoint.position), 0.0011);
  }
}

TEST(Path, StartsAndEndsAtItsEndsWhateverTheCorners) {
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    Rng rng(seed);
    const std::vector<Waypoint> waypoints = test::random_world(rng).waypoints;
    const Path path(waypoints);
    const Pose2 start = path.at(-1.0);
    const Pose2 end = path.at(path.duration_s() + 1.0);
    EXPECT_NEAR(start.x_m, waypoints.front().position.x_m, 1e-9);
    EXPECT_NEAR(start.y_m, waypoints.front().position.y_m, 1e-9);
    EXPECT_NEAR(end.x_m, waypoints.back().position.x_m, 1e-9) << "seed " << seed;
    EXPECT_NEAR(end.y_m, waypoints.back().position.y_m, 1e-9) << "seed " << seed;
  }
}

TEST(Path, RoundsACornerByTheArcThatTouchesBothLegs) {
  const std::vector<Waypoint> waypoints{
      {.position = {0.0, 0.0}},
      {.position = {4.0, 0.0}, .speed_mps = 1.0},
      {.position = {4.0, 4.0}, .speed_mps = 1.0, .turn_rate_radps = 10.0, .corner_radius_m = 1.0}};
  const Path path(waypoints);
  EXPECT_NEAR(path.length_m(), 6.0 + std::numbers::pi / 2.0, 1e-9);
  const Pose2 halfway = path.at(path.duration_s() / 2.0);
  EXPECT_NEAR(halfway.x_m, 3.0 + std::sqrt(0.5), 1e-9);
  EXPECT_NEAR(halfway.y_m, 1.0 - std::sqrt(0.5), 1e-9);
  EXPECT_NEAR(halfway.yaw_rad, std::numbers::pi / 4.0, 1e-9);
}

TEST(Path, TurnsBackOnTheSpot) {
  const std::vector<Waypoint> waypoints{
      {.position = {0.0, 0.0}},
      {.position = {1.0, 0.0}, .speed_mps = 1.0},
      {.position = {0.0, 0.0}, .speed_mps = 1.0, .turn_rate_radps = std::numbers::pi, .corner_radius_m = 0.5}};
  const Path path(waypoints);
  EXPECT_NEAR(path.duration_s(), 3.0, 1e-9);
  EXPECT_NEAR(path.at(1.5).x_m, 1.0, 1e-9);
  EXPECT_NEAR(std::abs(path.at(1.5).yaw_rad), std::numbers::pi / 2.0, 1e-9);
}

}  // namespace
}  // namespace odoless
