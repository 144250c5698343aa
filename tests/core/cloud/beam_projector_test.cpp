#include "core/cloud/beam_projector.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/core/cloud/cloud_support.hpp"

namespace odoless {
namespace {

constexpr double kHalfTurnRad = std::numbers::pi;

TEST(TiltMount, PositiveTiltLooksDown) {
  const TiltMount mount(TiltMountParams{});
  const Point3 ahead = mount.robot_T_laser(0.1) * Point3{10.0, 0.0, 0.0};
  EXPECT_NEAR(ahead.x_m, 10.0 * std::cos(0.1), 1e-12);
  EXPECT_NEAR(ahead.z_m, 0.6 - 10.0 * std::sin(0.1), 1e-12);
  const Point3 aside = mount.robot_T_laser(0.1) * Point3{0.0, 10.0, 0.0};
  EXPECT_NEAR(aside.z_m, 0.6, 1e-12) << "what lies on the axis stays level";
}

TEST(TiltMount, LaserOffTheAxisMovesOnACircle) {
  const TiltMount mount({.robot_T_tilt = {.x_m = 0.2, .z_m = 0.5}, .tilt_T_laser = {.x_m = 0.05, .z_m = 0.08}});
  const Pose3 level = mount.robot_T_laser(0.0);
  EXPECT_NEAR(level.origin_m.x(), 0.25, 1e-12);
  EXPECT_NEAR(mount.level_height_m(), 0.58, 1e-12);
  const Pose3 down = mount.robot_T_laser(kHalfTurnRad / 2.0);
  EXPECT_NEAR(down.origin_m.x(), 0.2 + 0.08, 1e-12);
  EXPECT_NEAR(down.origin_m.z(), 0.5 - 0.05, 1e-12);
}

TEST(Pose3, FramesCancel) {
  Rng rng(3);
  for (int i = 0; i < 50; ++i) {
    const Pose3 a_T_b = test::random_mount(rng).robot_T_tilt.pose();
    const Pose3 b_T_c = test::random_mount(rng).tilt_T_laser.pose();
    const Point3 p_c{rng.uniform(-5.0, 5.0), rng.uniform(-5.0, 5.0), rng.uniform(-5.0, 5.0)};
    const Point3 there = (a_T_b * b_T_c) * p_c;
    const Point3 stepwise = a_T_b * (b_T_c * p_c);
    const Point3 back = (a_T_b * b_T_c).inverse() * there;
    EXPECT_NEAR(there.x_m, stepwise.x_m, 1e-12);
    EXPECT_NEAR(there.z_m, stepwise.z_m, 1e-12);
    EXPECT_NEAR(back.x_m, p_c.x_m, 1e-12);
    EXPECT_NEAR(back.y_m, p_c.y_m, 1e-12);
    EXPECT_NEAR(back.z_m, p_c.z_m, 1e-12);
  }
}

// Any mount, tilt and motion: the same points as by the chain of frames, in the same order.
TEST(BeamProjector, PutsEachBeamWhereTheChainOfFramesDoes) {
  Rng rng(1);
  for (int run = 0; run < 40; ++run) {
    const int beams = 3 + static_cast<int>(rng.below(400));
    const TiltMountParams mount = test::random_mount(rng);
    const ScanFrame scan = test::scan_of(test::random_ranges_m(rng, beams));
    const std::vector<double> tilts_rad = test::random_tilts_rad(rng, beams);
    const Pose2 first = test::random_pose(rng);
    const Pose2 last = first * Pose2{rng.uniform(-0.2, 0.2), rng.uniform(-0.2, 0.2), rng.uniform(-0.3, 0.3)};
    BeamProjector projector(TiltMount(mount), beams);
    // The robot's middle moves evenly, not the laser: the oracle interpolates the same.
    const Pose2 robot_T_scan = TiltMount(mount).robot_T_scan();
    const Pose2 first_robot = first * robot_T_scan.inverse();
    const Pose2 last_robot = last * robot_T_scan.inverse();
    const std::span<const BeamPoint> points = projector.project(scan, tilts_rad, {first, last});
    ASSERT_EQ(static_cast<int>(points.size()), scan.returns());
    for (const BeamPoint& point : points) {
      const double share = static_cast<double>(point.beam) / (beams - 1);
      const Pose2 target_T_robot{first_robot.x_m + share * (last_robot.x_m - first_robot.x_m),
                                 first_robot.y_m + share * (last_robot.y_m - first_robot.y_m),
                                 first_robot.yaw_rad + share * wrap_angle(last_robot.yaw_rad - first_robot.yaw_rad)};
      const Point3 expected = test::plain_end(mount, scan, point.beam, tilts_rad[static_cast<std::size_t>(point.beam)],
                                              target_T_robot * robot_T_scan);
      EXPECT_NEAR(point.x_m, expected.x_m, 1e-5);
      EXPECT_NEAR(point.y_m, expected.y_m, 1e-5);
      EXPECT_NEAR(point.z_m, expected.z_m, 1e-5);
    }
  }
}

TEST(BeamProjector, LeavesOutBeamsWhoseAngleIsUnknown) {
  const ScanFrame scan = test::scan_of({1.0F, 2.0F, 3.0F, 4.0F});
  const double kUnknown = std::numeric_limits<double>::quiet_NaN();
  BeamProjector projector(TiltMount(TiltMountParams{}), 4);
  const auto points = projector.project(scan, std::vector<double>{0.0, kUnknown, 0.0, kUnknown}, {});
  ASSERT_EQ(points.size(), 2U);
  EXPECT_EQ(points[0].beam, 0);
  EXPECT_EQ(points[1].beam, 2);
}

// Moving the whole motion moves the points with it: nothing depends on where the map begins.
TEST(BeamProjector, MovesWithItsTarget) {
  Rng rng(5);
  const int beams = 181;
  const TiltMount mount(test::random_mount(rng));
  const ScanFrame scan = test::scan_of(test::random_ranges_m(rng, beams));
  const std::vector<double> tilts_rad = test::random_tilts_rad(rng, beams);
  const ScanMotion motion{test::random_pose(rng), test::random_pose(rng)};
  const Pose2 new_T_old = test::random_pose(rng);
  BeamProjector here(mount, beams);
  BeamProjector there(mount, beams);
  const auto before = here.project(scan, tilts_rad, motion);
  const auto after =
      there.project(scan, tilts_rad, {new_T_old * motion.target_T_first, new_T_old * motion.target_T_last});
  for (std::size_t i = 0; i < before.size(); ++i) {
    const Point2 moved = new_T_old * Point2{before[i].x_m, before[i].y_m};
    EXPECT_NEAR(after[i].x_m, moved.x_m, 1e-4);
    EXPECT_NEAR(after[i].y_m, moved.y_m, 1e-4);
    EXPECT_EQ(after[i].z_m, before[i].z_m);
  }
}

}  // namespace
}  // namespace odoless
