// When each beam was measured, as every driver tells it: what a laser on a driving robot sees lies where it is once the
// motion during the scan is taken out.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "core/scan/scan_frame.hpp"
#include "tests/drivers/lrf/tested_lasers.hpp"
#include "tests/tools/emulate_support.hpp"

namespace odoless {
namespace {

using test::Bench;
using test::HeardScan;
using test::kMs;
using test::kSecond;

constexpr std::int64_t kMovingUpNs = 12 * kSecond;
constexpr std::size_t kScans = 6;
constexpr std::int64_t kOnTheCircleNs = 2 * kSecond;
constexpr double kMovingErrorMaxM = 0.03;
constexpr double kMostOfThem = 0.9;  ///< all but those at edges, where a beam may see either surface

/// On a circle of 1 m at 2 m/s, so that it turns at 115 deg/s; each beam is measured at its own time. A laser that sees
/// less far has all of it smaller.
WorldDrive circling_robot(double sees_to_m) {
  constexpr int kLaps = 10;
  const double scale = std::min(sees_to_m / 6.0, 1.0);
  std::string text = fmt::format("room 0 0  {:.4f} {:.4f}\nbox {:.4f} {:.4f}  {:.4f} {:.4f}\n", 8 * scale, 6 * scale,
                                 6 * scale, 4.8 * scale, scale, 0.6 * scale);
  text += fmt::format("speed {:.4f}\nturn_rate 360\ncorner_radius {:.4f}\ngo", 2 * scale, scale);
  for (int corner = 0; corner < 8 * kLaps; ++corner) {  // of an octagon, rounded to a circle
    const double angle_rad = corner * std::numbers::pi / 4.0;
    const double to_corner_m = 1.0 / std::cos(std::numbers::pi / 8.0);
    text += fmt::format("  {:.4f} {:.4f}", scale * (4.0 + to_corner_m * std::cos(angle_rad)),
                        scale * (3.0 + to_corner_m * std::sin(angle_rad)));
  }
  WorldDrive drive;
  drive.world = parse_world(text + "\n", "circling");
  drive.noise_sd_m = 0.0;
  drive.distortion = true;
  return drive;
}

class MovingLaser : public ::testing::TestWithParam<test::TestedLaser> {
 protected:
  MovingLaser() : bench_(GetParam().model, {}, GetParam().params(), circling_robot(GetParam().sees_to_m)) {}

  void bring_up() {
    bench_.reset();
    for (const std::int64_t end_ns = bench_.now_ns() + kMovingUpNs; bench_.heard().scans.empty();) {
      ASSERT_LT(bench_.now_ns(), end_ns) << "no scan";
      bench_.run(5 * kMs);
    }
    bench_.run(kOnTheCircleNs);
  }

  [[nodiscard]] Pose2 world_T_laser(std::int64_t host_ns) {
    return bench_.source().world_T_robot(bench_.device().source_time_ns(host_ns).value()).value();
  }

  /// Mean over the scan.
  [[nodiscard]] Velocity2 velocity_of(const HeardScan& scan) {
    const std::int64_t sweep_ns = scan.beam_period_ns * static_cast<std::int64_t>(scan.ranges_m.size());
    const Pose2 moved = world_T_laser(scan.stamp_ns).inverse() * world_T_laser(scan.stamp_ns + sweep_ns);
    const double sweep_s = static_cast<double>(sweep_ns) * 1e-9;
    return {moved.x_m / sweep_s, moved.y_m / sweep_s, wrap_angle(moved.yaw_rad) / sweep_s};
  }

  /// By how much returns are off what is there, seen from where the laser was at the scan's stamp: that of the given
  /// share of them is smaller.
  [[nodiscard]] double error_m(const ScanFrame& scan, double share) {
    const std::int64_t time_ns = bench_.device().source_time_ns(scan.stamp_ns()).value();
    std::vector<EmulatedBeam> beams;
    std::vector<double> seen_m;
    for (int i = 0; i < scan.size(); ++i) {
      if (scan.is_return(i)) {
        beams.push_back({std::atan2(scan.direction(i).y_m, scan.direction(i).x_m), time_ns});
        seen_m.push_back(scan.range_m(i));
      }
    }
    std::vector<double> errors_m(beams.size());
    bench_.source().measure(0, beams, errors_m);
    for (std::size_t i = 0; i < errors_m.size(); ++i) {
      errors_m[i] = std::abs(seen_m[i] - errors_m[i]);
    }
    const auto at = errors_m.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(errors_m.size()));
    std::nth_element(errors_m.begin(), at, errors_m.end());
    return *at;
  }

  Bench bench_;
};

TEST_P(MovingLaser, SeesWhatIsThereOnceItsMotionIsTakenOut) {
  bring_up();
  const std::vector<HeardScan>& scans = bench_.heard().scans;
  ASSERT_GT(scans.size(), kScans);
  for (std::size_t i = scans.size() - kScans; i < scans.size(); ++i) {
    const HeardScan& heard = scans[i];
    if (heard.beam_period_ns == 0) {
      GTEST_SKIP() << "it does not tell when its beams are measured";
    }
    ScanFrame scan(ScanParams{});
    ASSERT_EQ(scan.assign({.stamp_ns = heard.stamp_ns,
                           .start_angle_rad = heard.start_angle_rad,
                           .angle_step_rad = heard.angle_step_rad,
                           .beam_period_ns = heard.beam_period_ns,
                           .ranges_m = heard.ranges_m}),
              Errc::kOk);
    const double skewed_m = error_m(scan, kMostOfThem);
    scan.deskew(velocity_of(heard));
    EXPECT_LT(error_m(scan, kMostOfThem), 0.5 * skewed_m) << i;
    EXPECT_LT(error_m(scan, kMostOfThem), kMovingErrorMaxM) << i;
  }
}

INSTANTIATE_TEST_SUITE_P(Lasers, MovingLaser, ::testing::ValuesIn(test::kTestedLasers),
                         [](const auto& tested) { return test::laser_name(tested); });

}  // namespace
}  // namespace odoless
