// What it is worth that a driver tells when each beam was measured: how far matches of its laser's scans are off on a
// turn of 180 deg/s, with the motion taken out of the scans and without. A table of it:
//   test_drivers --gtest_filter='*Deskew*' | grep '|'
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "core/odometry/laser_odometry.hpp"
#include "tests/drivers/lrf/tested_lasers.hpp"
#include "tests/tools/emulate_support.hpp"

namespace odoless {
namespace {

using test::Bench;
using test::HeardScan;
using test::kSecond;

constexpr std::int64_t kTurningNs = 3 * kSecond;
constexpr int kFirstScans = 4;  ///< in which the velocity isn't known yet

/// On a circle of half a metre at 1.57 m/s; each beam is measured at its own time.
WorldDrive turning_robot() {
  constexpr double kRadiusM = 0.5;
  std::string text =
      "room 0 0  8 6\nbox 6 4.8  1 0.6\nbox 1.5 1  0.5 1\nspeed 1.5708\nturn_rate 360\ncorner_radius 0.5\ngo";
  for (int corner = 0; corner < 80; ++corner) {  // of an octagon, rounded to a circle
    const double angle_rad = corner * std::numbers::pi / 4.0;
    const double to_corner_m = kRadiusM / std::cos(std::numbers::pi / 8.0);
    text += fmt::format("  {:.4f} {:.4f}", 4.0 + to_corner_m * std::cos(angle_rad),
                        3.0 + to_corner_m * std::sin(angle_rad));
  }
  WorldDrive drive;
  drive.world = parse_world(text + "\n", "turning");
  drive.noise_sd_m = 0.01;
  drive.distortion = true;
  return drive;
}

struct MatchErrors {
  double position_m = 0.0;  ///< medians
  double yaw_deg = 0.0;
};

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

class Deskew : public ::testing::TestWithParam<test::TestedLaser> {
 protected:
  Deskew() : bench_(GetParam().model, {}, GetParam().params(), turning_robot()) {}

  [[nodiscard]] Pose2 world_T_laser(std::int64_t host_ns) {
    return bench_.source().world_T_robot(bench_.device().source_time_ns(host_ns).value()).value();
  }

  [[nodiscard]] MatchErrors errors(const std::vector<HeardScan>& scans, bool deskews) {
    LaserOdometry odometry({}, {}, {}, {});
    Rng rng(1, 1);
    std::vector<double> positions_m;
    std::vector<double> yaws_deg;
    for (std::size_t i = 0; i < scans.size(); ++i) {
      const HeardScan& heard = scans[i];
      ScanFrame scan(ScanParams{});
      EXPECT_EQ(scan.assign({.stamp_ns = heard.stamp_ns,
                             .start_angle_rad = heard.start_angle_rad,
                             .angle_step_rad = heard.angle_step_rad,
                             .beam_period_ns = heard.beam_period_ns,
                             .ranges_m = heard.ranges_m}),
                Errc::kOk);
      if (deskews) {
        scan.deskew(odometry.velocity());
      }
      const Motion motion = odometry.process(scan, {}, rng);
      if (i >= kFirstScans) {
        const Pose2 truth = world_T_laser(scans[i - 1].stamp_ns).inverse() * world_T_laser(heard.stamp_ns);
        const Pose2 error = truth.inverse() * motion.previous_T_current;
        positions_m.push_back(std::hypot(error.x_m, error.y_m));
        yaws_deg.push_back(std::abs(wrap_angle(error.yaw_rad)) * 180.0 / std::numbers::pi);
      }
    }
    return {median(positions_m), median(yaws_deg)};
  }

  Bench bench_;
};

TEST_P(Deskew, MakesMatchesOnATurnBetter) {
  bench_.reset();
  bench_.run(2 * kSecond);
  const std::size_t first = bench_.heard().scans.size();
  bench_.run(kTurningNs);
  const std::vector<HeardScan>& all = bench_.heard().scans;
  ASSERT_GT(all.size(), first + 2 * kFirstScans);
  const std::vector<HeardScan> scans(all.begin() + static_cast<std::ptrdiff_t>(first), all.end());
  ASSERT_GT(scans.front().beam_period_ns, 0) << "its beams' times are known";
  const MatchErrors without = errors(scans, false);
  const MatchErrors with = errors(scans, true);
  const double rate_hz = static_cast<double>(scans.size() - 1) /
                         (static_cast<double>(scans.back().stamp_ns - scans.front().stamp_ns) * 1e-9);
  fmt::print("| {} | {:.1f} Hz | {:.1f} mm | {:.1f} mm | {:.3f} deg | {:.3f} deg |\n", GetParam().model, rate_hz,
             without.position_m * 1e3, with.position_m * 1e3, without.yaw_deg, with.yaw_deg);
  EXPECT_LT(with.position_m, 0.5 * without.position_m);
  EXPECT_LT(with.yaw_deg, 0.2 * without.yaw_deg);
}

/// One of each driver that tells when beams are measured.
std::vector<test::TestedLaser> lasers() {
  std::vector<test::TestedLaser> chosen;
  for (const test::TestedLaser& laser : test::kTestedLasers) {
    const std::string name = laser.name;
    const bool is_chosen = name == "scip_urg" || name == "rplidar_a3" || name == "rplidar_s2" ||
                           name == "ldrobot_ld06" || name == "ydlidar_g4" || name == "sopas_tim551" || name == "csv";
    if (is_chosen) {
      chosen.push_back(laser);
    }
  }
  return chosen;
}

INSTANTIATE_TEST_SUITE_P(Lasers, Deskew, ::testing::ValuesIn(lasers()),
                         [](const auto& tested) { return test::laser_name(tested); });

}  // namespace
}  // namespace odoless
