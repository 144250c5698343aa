#include "core/slam/scan_beams.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <numbers>
#include <vector>

#include "core/base/rng.hpp"

namespace odoless {
namespace {

/// Every fifth beam has no return, every seventh cannot be told.
ScanFrame mixed_scan(int beams) {
  std::vector<float> ranges_m;
  for (int i = 0; i < beams; ++i) {
    const float odd = i % 5 == 4 ? std::numeric_limits<float>::infinity() : std::numeric_limits<float>::quiet_NaN();
    ranges_m.push_back(i % 5 == 4 || i % 7 == 6 ? odd : 1.0F + 0.01F * static_cast<float>(i));
  }
  ScanFrame scan(ScanParams{.range_max_m = 12.0});
  EXPECT_EQ(scan.assign({.start_angle_rad = -1.0, .angle_step_rad = 0.01, .ranges_m = ranges_m}), Errc::kOk);
  return scan;
}

TEST(SelectBeams, TakesAllReturnsWhereThereIsRoom) {
  const ScanFrame scan = mixed_scan(100);
  std::vector<Beam> beams;
  select_beams(scan, 1000, false, beams);
  ASSERT_EQ(beams.size(), static_cast<std::size_t>(scan.returns()));
  EXPECT_TRUE(std::all_of(beams.begin(), beams.end(), [](const Beam& beam) { return beam.stopped; }));
  EXPECT_EQ(beams[0].range_m, scan.range_m(0));
}

TEST(SelectBeams, NeverTakesMoreThanAskedForAndMoreThanHalfOfThat) {
  for (int beams_max = 1; beams_max < 120; ++beams_max) {
    const ScanFrame scan = mixed_scan(200);
    std::vector<Beam> beams;
    select_beams(scan, beams_max, false, beams);
    EXPECT_LE(static_cast<int>(beams.size()), beams_max);
    EXPECT_GE(2 * static_cast<int>(beams.size()), beams_max);
  }
}

TEST(SelectBeams, TakesBeamsWithoutReturnOnlyWhenAsked) {
  const ScanFrame scan = mixed_scan(100);
  std::vector<Beam> beams;
  select_beams(scan, 1000, true, beams);
  const auto passed = std::count_if(beams.begin(), beams.end(), [](const Beam& beam) { return !beam.stopped; });
  EXPECT_EQ(passed, 20);
  EXPECT_TRUE(
      std::all_of(beams.begin(), beams.end(), [](const Beam& beam) { return beam.stopped || beam.range_m == 12.0; }));
}

TEST(BeamCaster, WalksToTheEndPointThatThePoseGives) {
  const GridGeometry grid{.resolution_m = 0.05, .columns = 400, .rows = 400};
  Rng rng(3);
  for (int i = 0; i < 200; ++i) {
    const Pose2 map_T_scan{rng.uniform(-3.0, 3.0), rng.uniform(-3.0, 3.0), rng.uniform(-3.1, 3.1)};
    const double angle_rad = rng.uniform(-3.1, 3.1);
    const Point2 direction{std::cos(angle_rad), std::sin(angle_rad)};
    const double range_m = rng.uniform(0.1, 6.0);
    GridWalk walk = BeamCaster(grid, map_T_scan).walk(direction, range_m);
    while (walk.next()) {
    }
    const Point2 end = map_T_scan * Point2{range_m * direction.x_m, range_m * direction.y_m};
    EXPECT_NEAR(walk.cell().column() + 0.5, grid.cells(end.x_m, end.y_m).x_m, 0.5 + 1e-6);
    EXPECT_NEAR(walk.cell().row() + 0.5, grid.cells(end.x_m, end.y_m).y_m, 0.5 + 1e-6);
    EXPECT_NEAR(walk.exit(), range_m / 0.05, 1e-4);
  }
}

}  // namespace
}  // namespace odoless
