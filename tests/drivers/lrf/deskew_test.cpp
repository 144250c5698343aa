// What it is worth that a driver tells when each beam was measured: how far matches of its laser's scans are off on a
// turn of 180 deg/s, straight on, and at rest, with the motion taken out of the scans and without. A table of it:
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

constexpr std::int64_t kDrivingNs = 3 * kSecond;
constexpr int kFirstScans = 4;  ///< in which the velocity isn't known yet

/// In a room with that path; each beam is measured at its own time.
WorldDrive drive_along(const std::string& path) {
  WorldDrive drive;
  drive.world = parse_world("room 0 0  8 6\nbox 6 4.8  1 0.6\nbox 1.5 1  0.5 1\n" + path + "\n", "driven");
  drive.noise_sd_m = 0.01;
  drive.distortion = true;
  return drive;
}

/// On a circle of half a metre at 1.57 m/s.
std::string turning() {
  constexpr double kRadiusM = 0.5;
  std::string path = "speed 1.5708\nturn_rate 360\ncorner_radius 0.5\ngo";
  for (int corner = 0; corner < 80; ++corner) {  // of an octagon, rounded to a circle
    const double angle_rad = corner * std::numbers::pi / 4.0;
    const double to_corner_m = kRadiusM / std::cos(std::numbers::pi / 8.0);
    path += fmt::format("  {:.4f} {:.4f}", 4.0 + to_corner_m * std::cos(angle_rad),
                        3.0 + to_corner_m * std::sin(angle_rad));
  }
  return path;
}

constexpr const char* kStraightOn = "speed 0.7\ngo 1 3  7 3";
constexpr const char* kStanding = "speed 0.01\ngo 2 3  2.01 3";

struct MatchErrors {
  double position_m = 0.0;  ///< medians
  double yaw_deg = 0.0;
};

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// A laser that is driven along a path.
class DrivenLaser {
 public:
  DrivenLaser(const test::TestedLaser& laser, const std::string& path)
      : bench_(laser.model, {}, laser.params(), drive_along(path)) {
    bench_.reset();
    bench_.run(2 * kSecond);
    const std::size_t first = bench_.heard().scans.size();
    bench_.run(kDrivingNs);
    const std::vector<HeardScan>& all = bench_.heard().scans;
    scans_.assign(all.begin() + static_cast<std::ptrdiff_t>(first), all.end());
  }

  [[nodiscard]] const std::vector<HeardScan>& scans() const { return scans_; }
  [[nodiscard]] double rate_hz() const {
    return static_cast<double>(scans_.size() - 1) /
           (static_cast<double>(scans_.back().stamp_ns - scans_.front().stamp_ns) * 1e-9);
  }

  [[nodiscard]] MatchErrors errors(bool deskews) {
    LaserOdometry odometry({}, {}, {}, {});
    Rng rng(1, 1);
    std::vector<double> positions_m;
    std::vector<double> yaws_deg;
    for (std::size_t i = 0; i < scans_.size(); ++i) {
      const HeardScan& heard = scans_[i];
      ScanFrame scan(ScanParams{});
      EXPECT_EQ(scan.assign({.stamp_ns = heard.stamp_ns,
                             .start_angle_rad = heard.start_angle_rad,
                             .angle_step_rad = heard.angle_step_rad,
                             .beam_period_ns = deskews ? heard.beam_period_ns : 0,
                             .ranges_m = heard.ranges_m}),
                Errc::kOk);
      const Motion motion = odometry.process(scan, {}, rng);
      if (i >= kFirstScans) {
        const Pose2 truth = world_T_laser(scans_[i - 1].stamp_ns).inverse() * world_T_laser(heard.stamp_ns);
        const Pose2 error = truth.inverse() * motion.previous_T_current;
        positions_m.push_back(std::hypot(error.x_m, error.y_m));
        yaws_deg.push_back(std::abs(wrap_angle(error.yaw_rad)) * 180.0 / std::numbers::pi);
      }
    }
    return {median(positions_m), median(yaws_deg)};
  }

 private:
  [[nodiscard]] Pose2 world_T_laser(std::int64_t host_ns) {
    return bench_.source().world_T_robot(bench_.device().source_time_ns(host_ns).value()).value();
  }

  Bench bench_;
  std::vector<HeardScan> scans_;
};

class Deskew : public ::testing::TestWithParam<test::TestedLaser> {};

TEST_P(Deskew, MakesMatchesOnATurnBetter) {
  DrivenLaser laser(GetParam(), turning());
  ASSERT_GT(laser.scans().size(), 2U * kFirstScans);
  ASSERT_GT(laser.scans().front().beam_period_ns, 0) << "its beams' times are known";
  const MatchErrors without = laser.errors(false);
  const MatchErrors with = laser.errors(true);
  fmt::print("| {} | {:.1f} Hz | {:.1f} mm | {:.1f} mm | {:.3f} deg | {:.3f} deg |\n", GetParam().model,
             laser.rate_hz(), without.position_m * 1e3, with.position_m * 1e3, without.yaw_deg, with.yaw_deg);
  EXPECT_LT(with.position_m, 0.5 * without.position_m);
  EXPECT_LT(with.yaw_deg, 0.2 * without.yaw_deg);
}

// The speed that the scans are deskewed with has errors of its own.
TEST_P(Deskew, DoesNoHarmStraightOnAndAtRest) {
  for (const char* const path : {kStraightOn, kStanding}) {
    DrivenLaser laser(GetParam(), path);
    const MatchErrors without = laser.errors(false);
    const MatchErrors with = laser.errors(true);
    fmt::print("| {}, {} | {:.2f} mm | {:.2f} mm | {:.4f} deg | {:.4f} deg |\n", GetParam().model,
               path == kStanding ? "at rest" : "straight on", without.position_m * 1e3, with.position_m * 1e3,
               without.yaw_deg, with.yaw_deg);
    EXPECT_LT(with.position_m, without.position_m + 0.0015);
    EXPECT_LT(with.yaw_deg, without.yaw_deg + 0.05);
  }
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
