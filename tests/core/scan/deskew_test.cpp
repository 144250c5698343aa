// A laser that moves while its mirror turns: with its motion taken out, what it sees is as straight as what one at rest
// sees.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/odometry/laser_odometry.hpp"
#include "tests/support/simulated_scene.hpp"

namespace odoless {
namespace {

constexpr std::int64_t kTurn_ns = 100'000'000;    // 10 Hz
constexpr double kFast_radps = std::numbers::pi;  // 180 degrees per second

/// The beams of a sweep, a degree apart.
struct DeskewedSweep {
  int beams = 271;
  double start_rad = -0.75 * std::numbers::pi;
  double step_rad = std::numbers::pi / 180.0;
};
constexpr DeskewedSweep kThreeQuarters{};
constexpr DeskewedSweep kWholeTurn{.beams = 360, .start_rad = -std::numbers::pi};
constexpr DeskewedSweep kClockwiseFromTheFront{.beams = 360, .start_rad = 0.0, .step_rad = -std::numbers::pi / 180.0};

/// Sweeps of a moving laser, each beam from where the laser is at its own time.
class MovingLaser {
 public:
  MovingLaser(SimulatedScene scene, const Velocity2& velocity, double noise_sd_m,
              const DeskewedSweep& sweep = kThreeQuarters)
      : scene_(std::move(scene)), velocity_(velocity), sweep_(sweep), ranges_m_(static_cast<std::size_t>(sweep.beams)) {
    laser_.noise_sd_m = noise_sd_m;
  }

  void drive(const Velocity2& velocity) { velocity_ = velocity; }

  /// Constant speed in the axes of the laser at the time 0 of each sweep, as the deskewing has it.
  [[nodiscard]] Pose2 moved(const Pose2& map_T_scan, double time_s) const {
    return map_T_scan * Pose2{velocity_.x_mps * time_s, velocity_.y_mps * time_s, velocity_.yaw_radps * time_s};
  }

  void sweep(const Pose2& map_T_scan, std::int64_t stamp_ns, ScanFrame& scan) {
    for (int i = 0; i < sweep_.beams; ++i) {
      const SimulatedLaser one{.beams = 1,
                               .start_angle_rad = sweep_.start_rad + i * sweep_.step_rad,
                               .angle_step_rad = sweep_.step_rad,
                               .noise_sd_m = laser_.noise_sd_m,
                               .range_max_m = 12.0};
      const double time_s = static_cast<double>(i * kBeam_ns) * 1e-9;
      ranges_m_[static_cast<std::size_t>(i)] = ranges_m(scene_, one, moved(map_T_scan, time_s), rng_)[0];
    }
    ASSERT_EQ(scan.assign({.stamp_ns = stamp_ns,
                           .start_angle_rad = sweep_.start_rad,
                           .angle_step_rad = sweep_.step_rad,
                           .beam_period_ns = kBeam_ns,
                           .ranges_m = ranges_m_}),
              Errc::kOk);
  }

  /// Root mean square of the distances from the scan's points to the walls.
  [[nodiscard]] double crookedness_m(const ScanFrame& scan, const Pose2& map_T_scan) const {
    double sum_m2 = 0.0;
    for (int i = 0; i < scan.size(); ++i) {
      const double off_m = scan.is_return(i) ? scene_.clearance_m(map_T_scan * scan.point(i)) : 0.0;
      sum_m2 += off_m * off_m;
    }
    return std::sqrt(sum_m2 / scan.returns());
  }

  static constexpr std::int64_t kBeam_ns = kTurn_ns / 360;

 private:
  SimulatedScene scene_;
  Velocity2 velocity_;
  DeskewedSweep sweep_;
  SimulatedLaser laser_;
  Rng rng_{3};
  std::vector<float> ranges_m_;
};

TEST(Deskew, MakesWallsAsStraightAsAtRest) {
  for (const Velocity2& velocity : {Velocity2{0.0, 0.0, kFast_radps}, Velocity2{0.0, 0.0, -kFast_radps},
                                    Velocity2{2.0, -1.0, 0.0}, Velocity2{1.0, 0.5, kFast_radps}}) {
    MovingLaser laser(cluttered_room(), velocity, 0.0);
    ScanFrame scan(ScanParams{});
    const Pose2 map_T_scan{-0.8, -1.2, 0.3};
    laser.sweep(map_T_scan, 0, scan);
    EXPECT_GT(laser.crookedness_m(scan, map_T_scan), 0.03) << "or there is nothing to take out";
    const int returns = scan.returns();
    scan.deskew(velocity);
    EXPECT_LT(laser.crookedness_m(scan, map_T_scan), 1e-4);
    EXPECT_EQ(scan.returns(), returns);
  }
}

/// Deskews 40 scans of a moving laser by the odometry's own velocity, which begins at rest, and holds them to scans at
/// rest.
void expect_straight_by_odometry(const Velocity2& velocity, const DeskewedSweep& sweep) {
  MovingLaser moving(cluttered_room(), velocity, 0.01, sweep);
  MovingLaser resting(cluttered_room(), {}, 0.01, sweep);
  ScanFrame scan(ScanParams{});
  Pose2 map_T_scan{-0.8, -1.2, 0.3};
  resting.sweep(map_T_scan, 0, scan);
  const double at_rest_m = resting.crookedness_m(scan, map_T_scan);
  LaserOdometry odometry({}, {}, {}, {});
  Rng rng(1);
  constexpr int kScans = 40;
  constexpr int kFirst = 6;
  double sum_m = 0.0;
  for (int i = 0; i < kScans; ++i) {
    moving.sweep(map_T_scan, i * kTurn_ns, scan);
    static_cast<void>(odometry.process(scan, {}, rng));
    if (i >= kFirst) {
      sum_m += moving.crookedness_m(scan, map_T_scan);
      EXPECT_NEAR(odometry.velocity().yaw_radps, velocity.yaw_radps, 0.1) << i;
    }
    map_T_scan = moving.moved(map_T_scan, 0.1);
  }
  EXPECT_LT(sum_m / (kScans - kFirst), 1.3 * at_rest_m);
}

TEST(Deskew, TheMatchersOwnVelocityWillDo) { expect_straight_by_odometry({0.0, 0.0, kFast_radps}, kThreeQuarters); }

// What is wrong with a speed must not come back a scan later with the other sign: where beams come all the time, it
// grew.
TEST(Deskew, ASpeedSettlesWhereASweepTakesTheWholePeriod) {
  for (const double speed_mps : {0.0, 0.8}) {
    expect_straight_by_odometry({speed_mps, 0.0, kFast_radps}, kWholeTurn);
    expect_straight_by_odometry({speed_mps, 0.0, kFast_radps}, kClockwiseFromTheFront);
    expect_straight_by_odometry({speed_mps, 0.0, -kFast_radps}, kClockwiseFromTheFront);
  }
}

// A robot that brakes hard and turns on the spot, and back: by the speed of the scan before, scans would be sheared by
// up to 4.5 deg and 0.06 m, and so would be what the next ones are matched to.
TEST(Deskew, AScanIsDeskewedWithTheSpeedThatItsOwnMatchTells) {
  MovingLaser laser(cluttered_room(), {}, 0.01, kWholeTurn);
  ScanFrame scan(ScanParams{});
  LaserOdometry odometry({}, {}, {}, {});
  Rng rng(1);
  const Pose2 map_T_first{-0.5, -1.9, 0.0};
  Pose2 map_T_scan = map_T_first;
  double turns = 0.0;  // 0: straight on; 1: on the spot
  for (int i = 0; i < 96; ++i) {
    turns = std::clamp(turns + (i % 16 < 6 ? -0.5 : 0.5), 0.0, 1.0);
    const double speed_mps = std::min(1.2, 0.4 * i) * (1.0 - turns);
    laser.drive({speed_mps, 0.0, turns * 0.5 * std::numbers::pi});
    laser.sweep(map_T_scan, i * kTurn_ns, scan);
    const Pose2 odom_T_scan = odometry.process(scan, {}, rng).odom_T_current;
    const Pose2 truth = map_T_first.inverse() * map_T_scan;
    EXPECT_LT(truth.distance_m(odom_T_scan), 0.05) << i;
    EXPECT_LT(std::abs(wrap_angle(truth.yaw_rad - odom_T_scan.yaw_rad)), 0.05) << i;
    map_T_scan = laser.moved(map_T_scan, 0.1);
  }
}

TEST(Deskew, WithAnotherSpeedIsAsIfWithThatAlone) {
  MovingLaser laser(cluttered_room(), {1.0, 0.5, kFast_radps}, 0.0);
  const Velocity2 last{0.7, -0.3, -2.0};
  ScanFrame once(ScanParams{});
  ScanFrame again(ScanParams{});
  laser.sweep({-0.8, -1.2, 0.3}, 0, once);
  laser.sweep({-0.8, -1.2, 0.3}, 0, again);
  once.deskew(last);
  again.deskew({1.0, 0.5, kFast_radps});
  again.deskew({});
  again.deskew(last);
  EXPECT_EQ(again.deskewed_s(), once.deskewed_s());
  EXPECT_EQ(again.deskewed_with().x_mps, last.x_mps);
  for (int i = 0; i < once.size(); ++i) {
    EXPECT_NEAR(again.range_m(i), once.range_m(i), 1e-5) << i;
    EXPECT_NEAR(again.direction(i).x_m, once.direction(i).x_m, 1e-6) << i;
    EXPECT_NEAR(again.direction(i).y_m, once.direction(i).y_m, 1e-6) << i;
    EXPECT_NEAR(again.angle_rad(i), once.angle_rad(i), 1e-9) << i;
  }
}

// What a log without beam times gives stays bit for bit.
TEST(Deskew, DoesNothingWhereNothingIsKnown) {
  const std::vector<float> ranges_m(180, 3.0F);
  for (const std::int64_t beam_period_ns : {std::int64_t{0}, std::int64_t{1'000'000'000}}) {
    ScanFrame scan(ScanParams{});
    ASSERT_EQ(scan.assign({.angle_step_rad = 0.01, .beam_period_ns = beam_period_ns, .ranges_m = ranges_m}), Errc::kOk);
    const ScanFrame before = scan;
    scan.deskew({1.0, 1.0, 1.0});
    for (int i = 0; i < scan.size(); ++i) {
      EXPECT_EQ(scan.range_m(i), before.range_m(i));
      EXPECT_EQ(scan.direction(i).x_m, before.direction(i).x_m);
      EXPECT_EQ(scan.direction(i).y_m, before.direction(i).y_m);
      EXPECT_EQ(scan.angle_rad(i), before.angle_rad(i));
    }
  }
}

TEST(Deskew, DoesNotBelieveWildSpeedsAndLeavesNothingBehind) {
  const std::vector<float> ranges_m(180, 3.0F);
  const RawScan raw{.angle_step_rad = 0.01, .beam_period_ns = 100'000, .ranges_m = ranges_m};
  ScanFrame scan(ScanParams{});
  ASSERT_EQ(scan.assign(raw), Errc::kOk);
  const ScanFrame before = scan;
  scan.deskew({100.0, 0.0, 0.0});
  EXPECT_EQ(scan.range_m(179), before.range_m(179));
  ASSERT_EQ(scan.assign(raw), Errc::kOk);
  scan.deskew({0.0, 0.0, std::nan("")});
  EXPECT_EQ(scan.direction(179).x_m, before.direction(179).x_m);
  ASSERT_EQ(scan.assign(raw), Errc::kOk);
  scan.deskew({1.0, 0.0, 1.0});
  EXPECT_NE(scan.direction(179).x_m, before.direction(179).x_m);
  ASSERT_EQ(scan.assign(raw), Errc::kOk);
  for (int i = 0; i < scan.size(); ++i) {
    EXPECT_EQ(scan.direction(i).x_m, before.direction(i).x_m);
    EXPECT_EQ(scan.angle_rad(i), before.angle_rad(i));
  }
}

}  // namespace
}  // namespace odoless
