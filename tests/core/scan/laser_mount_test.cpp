// However a laser is mounted, what its scans say of the room about the robot is the same.
#include "core/scan/laser_mount.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "tests/support/allocation_guard.hpp"

namespace odoless {
namespace {

constexpr double kDegree_rad = std::numbers::pi / 180.0;
constexpr double kStep_rad = 1.0 / 64.0;  // exact, so that a scan turned round and back is the very same
constexpr int kBeams = 200;

std::vector<float> some_ranges_m() {
  std::vector<float> ranges_m;
  for (int i = 0; i < kBeams; ++i) {
    ranges_m.push_back(1.0F + 0.01F * static_cast<float>(i));
  }
  return ranges_m;
}

RawScan scan_of(const std::vector<float>& ranges_m) {
  return {.stamp_ns = 5,
          .start_angle_rad = -0.5 * (kBeams - 1) * kStep_rad,
          .angle_step_rad = kStep_rad,
          .beam_period_ns = 1000,
          .ranges_m = ranges_m};
}

TEST(LaserMount, LeavesAScanOfAnUprightLaserAsItIs) {
  const std::vector<float> ranges_m = some_ranges_m();
  const RawScan raw = scan_of(ranges_m);
  for (const bool is_both : {false, true}) {
    LaserMount mount({.upside_down = is_both, .mirrored = is_both}, kBeams);
    const RawScan out = mount.apply(raw);
    EXPECT_EQ(out.ranges_m.data(), raw.ranges_m.data());
    EXPECT_EQ(out.start_angle_rad, raw.start_angle_rad);
    EXPECT_EQ(out.angle_step_rad, raw.angle_step_rad);
    EXPECT_EQ(out.first_beam_ns, 0);
    EXPECT_EQ(out.beam_period_ns, raw.beam_period_ns);
  }
}

TEST(LaserMount, GivesTheVeryScanOfAnUprightLaserWhereItHangsUpsideDown) {
  const std::vector<float> upright_m = some_ranges_m();
  const std::vector<float> hanging_m(upright_m.rbegin(), upright_m.rend());  // its first beam looks to the left
  for (const LaserMountParams& params : {LaserMountParams{.upside_down = true}, LaserMountParams{.mirrored = true}}) {
    LaserMount mount(params, kBeams);
    const RawScan out = mount.apply(scan_of(hanging_m));
    EXPECT_EQ(std::vector(out.ranges_m.begin(), out.ranges_m.end()), upright_m);
    EXPECT_EQ(out.start_angle_rad, scan_of(upright_m).start_angle_rad);
    EXPECT_EQ(out.angle_step_rad, kStep_rad);
    EXPECT_EQ(out.first_beam_ns, (kBeams - 1) * 1000) << "its last beam comes first here";
    EXPECT_EQ(out.beam_period_ns, -1000);
  }
}

TEST(LaserMount, TellsTheTimesOfBeamsWhereTheScanDoesNot) {
  const std::vector<float> ranges_m = some_ranges_m();
  RawScan untold = scan_of(ranges_m);
  untold.beam_period_ns = 0;
  constexpr std::int64_t kSweep_ns = 100'000'000;
  constexpr std::int64_t kToLast_ns = (kBeams - 1) * (kSweep_ns / kBeams);
  for (const bool is_hanging : {false, true}) {
    for (const bool is_last_first : {false, true}) {
      LaserMount mount({.upside_down = is_hanging, .sweep_ns = is_last_first ? -kSweep_ns : kSweep_ns}, kBeams);
      const RawScan out = mount.apply(untold);
      const bool is_reversed = is_hanging != is_last_first;
      EXPECT_EQ(out.beam_period_ns, (is_reversed ? -kSweep_ns : kSweep_ns) / kBeams);
      EXPECT_EQ(out.first_beam_ns, is_reversed ? kToLast_ns : 0) << "the first that is measured has the stamp";
      EXPECT_EQ(mount.apply(scan_of(ranges_m)).beam_period_ns, is_hanging ? -1000 : 1000) << "what it tells is so";
    }
  }
  LaserMount mount({.sweep_ns = kSweep_ns}, kBeams);
  EXPECT_EQ(mount.apply({}).beam_period_ns, 0) << "no beams";
}

TEST(LaserMount, TurnsBearingsByTheYaw) {
  const std::vector<float> ranges_m = some_ranges_m();
  LaserMount mount({.yaw_rad = 0.5}, kBeams);
  EXPECT_DOUBLE_EQ(mount.apply(scan_of(ranges_m)).start_angle_rad, scan_of(ranges_m).start_angle_rad + 0.5);
  LaserMount hanging({.yaw_rad = 0.5, .upside_down = true}, kBeams);
  const RawScan raw = scan_of(ranges_m);
  const RawScan out = hanging.apply(raw);
  for (const int beam : {0, 17, kBeams - 1}) {
    const double laser_rad = raw.start_angle_rad + beam * raw.angle_step_rad;
    const double scan_rad = out.start_angle_rad + (kBeams - 1 - beam) * out.angle_step_rad;
    EXPECT_NEAR(scan_rad, LaserPlace::of({.yaw_rad = 0.5, .upside_down = true}).bearing_rad(laser_rad), 1e-12);
  }
}

/// Beams that are left, as whole degrees of the robot.
std::vector<int> used_degrees(const LaserMountParams& params) {
  std::vector<float> ranges_m(360, 2.0F);
  LaserMount mount(params, 360);
  const RawScan out =
      mount.apply({.start_angle_rad = -std::numbers::pi, .angle_step_rad = kDegree_rad, .ranges_m = ranges_m});
  std::vector<int> used;
  for (std::size_t i = 0; i < out.ranges_m.size(); ++i) {
    if (std::isfinite(out.ranges_m[i])) {
      used.push_back(static_cast<int>(
          std::lround(wrap_angle(out.start_angle_rad + static_cast<double>(i) * out.angle_step_rad) / kDegree_rad)));
    }
  }
  return used;
}

TEST(LaserMount, IgnoresSectorsOfTheRobotHoweverTheLaserIsTurned) {
  const std::vector<AngleSector> behind{{170.0 * kDegree_rad, -170.0 * kDegree_rad},
                                        {20.0 * kDegree_rad, 30.0 * kDegree_rad}};
  for (const double yaw_deg : {0.0, 90.0, -135.0}) {
    for (const bool is_upside_down : {false, true}) {
      const std::vector<int> used =
          used_degrees({.yaw_rad = yaw_deg * kDegree_rad, .upside_down = is_upside_down, .ignore = behind});
      EXPECT_EQ(used.size(), 360U - 21U - 11U) << yaw_deg << is_upside_down;
      for (const int degree : used) {
        EXPECT_LT(std::abs(degree), 170);
        EXPECT_TRUE(degree < 20 || degree > 30) << degree;
      }
    }
  }
}

TEST(LaserMount, UsesBeamsFromTheLeastAngleToTheMost) {
  EXPECT_EQ(used_degrees({.angle_min_rad = -45.0 * kDegree_rad, .angle_max_rad = 60.0 * kDegree_rad}).size(), 106U);
  for (const int degree : used_degrees({.angle_min_rad = 90.0 * kDegree_rad, .angle_max_rad = -90.0 * kDegree_rad})) {
    EXPECT_GE(std::abs(degree), 90) << "over the robot's back";
  }
}

TEST(LaserMount, MasksWhatIsRecordedInTheLasersOwnOrder) {
  std::vector<float> ranges_m = some_ranges_m();
  const RawScan raw = scan_of(ranges_m);
  LaserMount mount({.upside_down = true, .ignore = {{0.0, std::numbers::pi}}}, kBeams);
  std::vector<float> recorded_m = ranges_m;
  mount.mask(raw, recorded_m);
  for (std::size_t i = 0; i < recorded_m.size(); ++i) {
    const bool is_left_of_robot = i < kBeams / 2;  // of the hanging laser's right
    EXPECT_EQ(recorded_m[i], is_left_of_robot ? 0.0F : ranges_m[i]) << i;
  }
  std::vector<float> again_m = recorded_m;
  mount.mask(raw, again_m);
  EXPECT_EQ(again_m, recorded_m) << "as a log that is played again";
}

TEST(LaserMount, LeavesToTheFrameWhatCannotBe) {
  const std::vector<float> ranges_m = some_ranges_m();
  LaserMount mount({.upside_down = true, .ignore = {{-1.0, 1.0}}}, kBeams - 1);
  EXPECT_EQ(mount.apply(scan_of(ranges_m)).ranges_m.size(), ranges_m.size()) << "too many beams";
  RawScan wild = scan_of(ranges_m);
  wild.start_angle_rad = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(std::isnan(mount.apply(wild).start_angle_rad));
  EXPECT_EQ(mount.apply({}).ranges_m.size(), 0U);
}

TEST(LaserMount, UsesNoHeapForAScan) {
  if (!AllocationGuard::kWorks) {
    GTEST_SKIP() << "the sanitizer owns the heap functions";
  }
  const std::vector<float> ranges_m = some_ranges_m();
  std::vector<float> recorded_m = ranges_m;
  LaserMount mount({.upside_down = true, .ignore = {{-1.0, 1.0}}}, kBeams);
  const AllocationGuard guard;
  static_cast<void>(mount.apply(scan_of(ranges_m)));
  mount.mask(scan_of(ranges_m), recorded_m);
  EXPECT_EQ(guard.calls(), 0);
}

TEST(LaserPlace, GoesFromTheScanToTheRobotAndBack) {
  const LaserPlace place{.x_m = 0.3, .y_m = -0.1, .yaw_rad = 1.0};
  const Pose2 map_T_robot{1.0, 2.0, 0.7};
  const Pose2 back = place.robot_of(place.scan_of(map_T_robot));
  EXPECT_NEAR(back.distance_m(map_T_robot), 0.0, 1e-12);
  EXPECT_NEAR(back.yaw_rad, 0.7, 1e-12);
  EXPECT_NEAR(place.scan_of({0.0, 0.0, std::numbers::pi / 2.0}).x_m, 0.1, 1e-12) << "ahead is along y of the map";
}

}  // namespace
}  // namespace odoless
