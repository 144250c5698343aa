// Laser odometry along walls without features, where a robot that drives looks like one that rests.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/geometry/pose2_covariance.hpp"
#include "core/odometry/laser_odometry.hpp"
#include "tests/support/simulated_scene.hpp"

namespace odoless {
namespace {

/// Two walls, 2 m apart, that end at a third one.
SimulatedScene blind_alley() {
  SimulatedScene scene;
  scene.walls = {{{-60.0, 1.0}, {0.0, 1.0}}, {{-60.0, -1.0}, {0.0, -1.0}}, {{0.0, -1.0}, {0.0, 1.0}}};
  return scene;
}

/// A robot on its way along the alley, that looks towards its end.
class AlleyDrive {
 public:
  AlleyDrive(double start_m, double scans_per_s) : at_m_(start_m), rate_hz_(scans_per_s) {}

  void drive(double speed_mps, double time_s) {
    for (int i = 0; i < std::lround(time_s * rate_hz_); ++i) {
      at_m_ += speed_mps / rate_hz_;
      stamp_ns_ += std::llround(1e9 / rate_hz_);
      ScanFrame scan = sweep(alley_, laser_, {at_m_, 0.0, 0.0}, rng_, stamp_ns_);
      const Motion step = odometry_.process(scan, {}, rng_);
      moved_ = moved_.then(step);
      odom_m_ = step.odom_T_current.x_m;
    }
  }

  [[nodiscard]] double at_m() const { return at_m_; }
  [[nodiscard]] double odom_m() const { return odom_m_; }
  /// That the motion since the beginning is known within what OK allows: probability.
  [[nodiscard]] double known() const { return probability_within(moved_.covariance(), 0.5, 0.087); }

 private:
  SimulatedScene alley_ = blind_alley();
  SimulatedLaser laser_{
      .beams = 541, .angle_step_rad = 1.5 * std::numbers::pi / 540, .noise_sd_m = 0.015, .range_max_m = 8.0};
  LaserOdometry odometry_{{}, {}, {}, {}};
  Rng rng_{1};
  double at_m_;
  double rate_hz_;
  double odom_m_ = 0.0;
  std::int64_t stamp_ns_ = 1'000'000'000;
  Motion moved_{};
};

TEST(FeaturelessCorridor, NoRateOfScansMakesItsLengthKnown) {
  constexpr double kSure = 0.9;  // RecoveryParams::sure_probability
  for (const double rate_hz : {5.0, 10.0, 25.0, 50.0}) {
    AlleyDrive robot(-50.0, rate_hz);
    robot.drive(0.5, 6.0);
    EXPECT_LT(robot.known(), kSure) << rate_hz << " scans a second";
  }
}

TEST(FeaturelessCorridor, AWallThatHoldsThePoseIsBelievedAtAnyRate) {
  for (const double rate_hz : {5.0, 50.0}) {
    AlleyDrive robot(-4.0, rate_hz);
    robot.drive(0.3, 6.0);
    EXPECT_GT(robot.known(), 0.999) << rate_hz << " scans a second";
    EXPECT_NEAR(robot.odom_m(), robot.at_m() + 4.0, 0.1) << rate_hz << " scans a second";
  }
}

}  // namespace
}  // namespace odoless
