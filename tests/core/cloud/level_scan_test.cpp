#include "core/cloud/level_scan.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/core/cloud/cloud_support.hpp"

namespace odoless {
namespace {

constexpr int kBeams = 541;

/// Range from the middle of a square tower of 8 m x 8 m without floor or ceiling, along a direction of space.
double tower_range_m(const Eigen::Vector3d& direction) {
  const double along_x = std::abs(direction.x()) > 1e-9 ? 4.0 / std::abs(direction.x()) : 1e9;
  const double along_y = std::abs(direction.y()) > 1e-9 ? 4.0 / std::abs(direction.y()) : 1e9;
  return std::min(along_x, along_y);
}

/// A scan at one tilt angle there, the laser in its axis at the tower's middle.
ScanFrame tower_scan(double tilt_rad) {
  const Pose3 turn = Pose3::of({}, 0.0, tilt_rad, 0.0);
  std::vector<float> ranges_m;
  for (int i = 0; i < kBeams; ++i) {
    const double angle_rad = -0.75 * std::numbers::pi + i * 1.5 * std::numbers::pi / (kBeams - 1);
    const Eigen::Vector3d direction = turn.rotation * Eigen::Vector3d(std::cos(angle_rad), std::sin(angle_rad), 0.0);
    ranges_m.push_back(static_cast<float>(tower_range_m(direction)));
  }
  return test::scan_of(ranges_m);
}

LevelScan level_scan(double tilt_max_rad = 0.5) {
  return {TiltMount(TiltMountParams{}),
          {.tilt_max_rad = tilt_max_rad, .below_m = 0.5, .above_m = 0.5, .returns_min = 20},
          kBeams};
}

// Walls are upright: what a tilted laser sees near its height is what the level one sees there.
TEST(LevelScan, SeesUprightWallsAsTheLevelLaserDoes) {
  const ScanFrame truth = tower_scan(0.0);
  for (const double tilt_rad : {-0.3, -0.1, 0.0, 0.05, 0.2}) {
    LevelScan level = level_scan();
    const Result<std::span<const float>> made = level.make(tower_scan(tilt_rad), std::vector<double>(kBeams, tilt_rad));
    ASSERT_TRUE(made.ok());
    int known = 0;
    for (int i = 0; i < kBeams; ++i) {
      const float range_m = made.value()[static_cast<std::size_t>(i)];
      known += range_m > 0.0F ? 1 : 0;
      if (range_m > 0.0F) {
        EXPECT_NEAR(range_m, truth.range_m(i), 0.03)
            << "beam " << i << " at " << tilt_rad;  // half a beam's width aside
      }
    }
    EXPECT_GT(known, std::abs(tilt_rad) < 0.06 ? kBeams * 9 / 10 : 100);
  }
}

TEST(LevelScan, IsTheScanItselfWhereTheLaserIsLevel) {
  LevelScan level = level_scan();
  const ScanFrame scan = tower_scan(0.0);
  const Result<std::span<const float>> made = level.make(scan, std::vector<double>(kBeams, 0.0));
  ASSERT_TRUE(made.ok());
  for (int i = 0; i < kBeams; ++i) {
    EXPECT_NEAR(made.value()[static_cast<std::size_t>(i)], scan.range_m(i), 1e-5);
  }
}

TEST(LevelScan, LeavesOutWhatIsHigherOrLower) {
  LevelScan level = level_scan();
  const Result<std::span<const float>> made = level.make(tower_scan(0.4), std::vector<double>(kBeams, 0.4));
  ASSERT_TRUE(made.ok());
  EXPECT_EQ(made.value()[kBeams / 2], 0.0F) << "straight ahead it looks 1.7 m down";
}

TEST(LevelScan, RefusesScansThatAreTiltedTooFarOrUnknown) {
  LevelScan level = level_scan(0.1);
  std::vector<double> tilts_rad(kBeams, 0.05);
  EXPECT_TRUE(level.make(tower_scan(0.05), tilts_rad).ok());
  tilts_rad.back() = 0.11;
  EXPECT_EQ(level.make(tower_scan(0.05), tilts_rad).error(), Errc::kTooFewReturns);
  tilts_rad.back() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(level.make(tower_scan(0.05), tilts_rad).error(), Errc::kTooFewReturns);
  EXPECT_EQ(level.make(test::scan_of(std::vector<float>(kBeams, 0.0F)), std::vector<double>(kBeams, 0.0)).error(),
            Errc::kTooFewReturns);
}

}  // namespace
}  // namespace odoless
