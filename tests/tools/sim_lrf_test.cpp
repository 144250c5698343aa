#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/tools/sim_support.hpp"
#include "tools/sim/ray_caster.hpp"
#include "tools/sim/simulated_lrf.hpp"

namespace odoless {
namespace {

/// A robot in the middle of a wide ring wall; it never moves far.
World ring(double radius_m) {
  return {.pillars = {{{0.0, 0.0}, radius_m}},
          .waypoints = {{.position = {0.0, 0.0}}, {.position = {0.01, 0.0}, .speed_mps = 0.01}}};
}

std::vector<double> first_sweep(const World& world, const SimulatedLrfParams& params, std::uint64_t seed) {
  SimulatedLrf lrf(params, seed);
  const std::span<const double> ranges_m = lrf.sweep(world, Path(world.waypoints), 0.0);
  return {ranges_m.begin(), ranges_m.end()};
}

TEST(SimulatedLrf, NoiseHasItsMeanAndDeviation) {
  for (const double noise_sd_m : {0.015, 0.08}) {
    const auto ranges_m = first_sweep(ring(5.0), {.beams = 10'000, .noise_sd_m = noise_sd_m}, 4);
    double sum_m = 0.0;
    double square_m2 = 0.0;
    for (const double range_m : ranges_m) {
      sum_m += range_m - 5.0;
      square_m2 += (range_m - 5.0) * (range_m - 5.0);
    }
    EXPECT_NEAR(sum_m / 10'000.0, 0.0, 4.0 * noise_sd_m / 100.0);
    EXPECT_NEAR(std::sqrt(square_m2 / 10'000.0), noise_sd_m, 0.03 * noise_sd_m);
  }
}

TEST(SimulatedLrf, WithoutNoiseEachBeamIsTheRayAtItsAngle) {
  Rng rng(5);
  const World world = test::random_world(rng);
  const SimulatedLrfParams params{.field_of_view_rad = 240.0 * test::kRadPerDeg, .beams = 25, .noise_sd_m = 0.0};
  const auto ranges_m = first_sweep(world, params, 1);
  const Pose2 pose = Path(world.waypoints).at(0.0);
  for (int i = 0; i < 25; ++i) {
    const double angle_rad = pose.yaw_rad + (-120.0 + 10.0 * i) * test::kRadPerDeg;
    const Point2 origin{pose.x_m, pose.y_m};
    const double expected_m = cast_ray_m(world, origin, {std::cos(angle_rad), std::sin(angle_rad)});
    const double range_m = ranges_m[static_cast<std::size_t>(i)];
    EXPECT_TRUE(range_m == expected_m || std::abs(range_m - expected_m) < 1e-9) << "beam " << i;
  }
}

TEST(SimulatedLrf, FullCircleSharesNoBeamBetweenItsEnds) {
  const SimulatedLrf lrf({.field_of_view_rad = 2.0 * std::numbers::pi, .beams = 360}, 1);
  EXPECT_NEAR(lrf.angle_step_rad(), test::kRadPerDeg, 1e-12);
  EXPECT_NEAR(lrf.start_angle_rad(), -std::numbers::pi, 1e-12);
}

TEST(SimulatedLrf, EveryPresetIsAValidLaserOfTheDataSheet) {
  for (const LrfModel& model : lrf_models()) {
    const SimulatedLrfParams params = simulated_lrf_params(model);
    EXPECT_TRUE(parameters_in_range(params)) << model.name;
    EXPECT_EQ(params.beams, model.beams);
    EXPECT_DOUBLE_EQ(params.field_of_view_rad, model.field_of_view_deg * test::kRadPerDeg);
    EXPECT_EQ(params.rate_hz, model.rate_hz);
    EXPECT_EQ(params.range_max_m, model.range_max_m);
    EXPECT_EQ(params.noise_sd_m, model.range_sd_m);
  }
}

TEST(SimulatedLrf, SurfacesBeyondItsRangeGiveNoReturn) {
  for (const double range_m : first_sweep(ring(5.0), {.range_max_m = 4.99, .noise_sd_m = 0.1}, 6)) {
    EXPECT_TRUE(std::isinf(range_m));
  }
  for (const double range_m : first_sweep(ring(5.0), {.range_max_m = 5.1, .noise_sd_m = 0.1}, 6)) {
    EXPECT_TRUE(std::isinf(range_m) || range_m < 5.1);
  }
}

TEST(SimulatedLrf, LosesItsShareOfBeamsAndLeavesTheOthersAsTheyWere) {
  const World world = ring(5.0);
  const auto all_m = first_sweep(world, {.beams = 10'000}, 7);
  const auto some_m = first_sweep(world, {.beams = 10'000, .no_return_share = 0.2}, 7);
  int lost = 0;
  for (std::size_t i = 0; i < all_m.size(); ++i) {
    lost += std::isinf(some_m[i]) ? 1 : 0;
    EXPECT_TRUE(std::isinf(some_m[i]) || some_m[i] == all_m[i]);
  }
  EXPECT_NEAR(lost, 2000, 160);
}

TEST(SimulatedLrf, MovingWorldAndPathTogetherChangesNoRange) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    Rng rng(seed);
    const World world = test::random_world(rng);
    const Pose2 new_T_old{rng.uniform(-50.0, 50.0), rng.uniform(-50.0, 50.0), rng.uniform(-3.1, 3.1)};
    const World moved = test::transformed(new_T_old, world);
    const Path path(world.waypoints);
    const Path moved_path(moved.waypoints);
    SimulatedLrf lrf({.distortion = seed % 2 == 0}, seed);
    SimulatedLrf moved_lrf(lrf);
    for (double time_s = 0.0; time_s < path.duration_s(); time_s += 1.7) {
      const auto ranges_m = lrf.sweep(world, path, time_s);
      const auto moved_ranges_m = moved_lrf.sweep(moved, moved_path, time_s);
      for (std::size_t i = 0; i < ranges_m.size(); ++i) {
        ASSERT_TRUE(ranges_m[i] == moved_ranges_m[i] || std::abs(ranges_m[i] - moved_ranges_m[i]) < 1e-7)
            << "seed " << seed << ", beam " << i << ", at " << time_s;
      }
    }
  }
}

TEST(SimulatedLrf, DistortionCastsEachBeamAtItsOwnTime) {
  const World world{.segments = {{{10.0, -50.0}, {10.0, 50.0}}},
                    .waypoints = {{.position = {0.0, 0.0}}, {.position = {9.0, 0.0}, .speed_mps = 1.0}}};
  const SimulatedLrfParams params{.beams = 181, .rate_hz = 1.0, .noise_sd_m = 0.0, .distortion = true};
  const auto ranges_m = first_sweep(world, params, 1);
  // The mirror turns by 90 deg, a quarter of the period of 1 s, until the middle beam leaves.
  EXPECT_NEAR(ranges_m[90], 10.0 - 0.25, 1e-9);
  SimulatedLrfParams still = params;
  still.distortion = false;
  EXPECT_NEAR(first_sweep(world, still, 1)[90], 10.0, 1e-9);
}

}  // namespace
}  // namespace odoless
