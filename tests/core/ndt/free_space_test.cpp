#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "core/base/rng.hpp"
#include "core/ndt/score_raster.hpp"
#include "tests/core/ndt/plain_ndt.hpp"

namespace odoless {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kMargin_m = 0.15;
constexpr double kFreePenalty = 0.7;
constexpr RasterParams kFreeRaster{.resolution_m = 0.05, .extent_m = 4.0, .sigma_min_m = 0.05};
constexpr float kNothing = std::numeric_limits<float>::infinity();

struct Sweep {
  double start_angle_rad;
  double angle_step_rad;
  std::vector<float> ranges_m;
};

ScanFrame to_scan(const Sweep& sweep) {
  ScanFrame scan(ScanParams{});
  EXPECT_EQ(scan.assign({.start_angle_rad = sweep.start_angle_rad,
                         .angle_step_rad = sweep.angle_step_rad,
                         .ranges_m = sweep.ranges_m}),
            Errc::kOk);
  return scan;
}

// How far beam `beam` sees through, by its own return and its neighbours'; 0: it says nothing.
double free_until_m(const ScanFrame& scan, int beam) {
  double until_m = scan.is_return(beam) ? scan.range_m(beam) : 0.0;
  for (int i = std::max(0, beam - 1); i <= std::min(scan.size() - 1, beam + 1); ++i) {
    until_m = scan.is_return(i) ? std::min(until_m, scan.range_m(i)) : until_m;
  }
  until_m -= kMargin_m;
  return until_m > kFreeRaster.resolution_m ? until_m : 0.0;  // less than a pixel says nothing
}

// The oracle: whether some beam of the first turn, whose sector holds the point, sees through it.
bool is_free(const ScanFrame& scan, const Pose2& reference_T_scan, const Point2& p_reference) {
  const Point2 p = reference_T_scan.inverse() * p_reference;
  const double angle_rad = std::atan2(p.y_m, p.x_m);
  const double step_rad = std::abs(scan.angle_step_rad());
  for (int beam = 0; beam < scan.size() && (beam + 1) * step_rad <= 2.0 * kPi + 1e-6; ++beam) {
    if (std::abs(wrap_angle(angle_rad - scan.angle_rad(beam))) < 0.5 * step_rad &&
        std::hypot(p.x_m, p.y_m) < free_until_m(scan, beam)) {
      return true;
    }
  }
  return false;
}

// Whether the answer is the same all around the point, at a hundredth of a pixel.
bool is_clear_cut(const ScanFrame& scan, const Pose2& reference_T_scan, const Point2& p_reference) {
  const double aside_m = 0.01 * kFreeRaster.resolution_m;
  int votes = 0;
  for (int i = 0; i < 8; ++i) {
    const Point2 near{p_reference.x_m + aside_m * std::cos(0.25 * i * kPi + 0.1),
                      p_reference.y_m + aside_m * std::sin(0.25 * i * kPi + 0.1)};
    votes += is_free(scan, reference_T_scan, near) ? 1 : 0;
  }
  return votes == 0 || votes == 8;
}

// Compares every pixel of an unpainted raster with the oracle; returns how many were free.
int expect_marked_as_oracle_says(const Sweep& sweep, const Pose2& reference_T_scan) {
  const ScanFrame scan = to_scan(sweep);
  ScoreRaster raster(kFreeRaster);
  raster.mark_free(scan, reference_T_scan, kMargin_m, kFreePenalty);
  int marked = 0;
  int wrong = 0;
  int unclear = 0;
  for (int column = -80; column < 80; ++column) {
    for (int row = -80; row < 80; ++row) {
      const Point2 centre{(column + 0.5) * kFreeRaster.resolution_m, (row + 0.5) * kFreeRaster.resolution_m};
      const bool is_marked = raster.at(centre) < 0.0;
      marked += is_marked ? 1 : 0;
      if (is_marked == is_free(scan, reference_T_scan, centre)) {
        continue;
      }
      (is_clear_cut(scan, reference_T_scan, centre) ? wrong : unclear) += 1;
    }
  }
  EXPECT_EQ(wrong, 0) << "start " << sweep.start_angle_rad << " step " << sweep.angle_step_rad << " at "
                      << reference_T_scan.x_m << ' ' << reference_T_scan.y_m << ' ' << reference_T_scan.yaw_rad;
  EXPECT_LT(unclear, 20);
  return marked;
}

std::vector<float> random_ranges_m(int beams, Rng& rng) {
  std::vector<float> out_m;
  double range_m = 2.0;
  for (int i = 0; i < beams; ++i) {
    range_m = rng.below(10) == 0 ? rng.uniform(0.1, 5.0) : range_m + rng.uniform(-0.05, 0.05);
    out_m.push_back(rng.below(12) == 0 ? kNothing : static_cast<float>(range_m));
  }
  return out_m;
}

TEST(FreeSpace, RandomSweepsOfAnyGeometryMarkWhatTheyWentThrough) {
  Rng rng(1);
  for (int round = 0; round < 40; ++round) {
    const int beams = 20 + static_cast<int>(rng.below(200));
    const double field_rad = rng.uniform(0.3, 2.0 * kPi);
    const double sign = round % 2 == 0 ? 1.0 : -1.0;
    const Sweep sweep{rng.uniform(-7.0, 7.0), sign * field_rad / beams, random_ranges_m(beams, rng)};
    const Pose2 pose{rng.uniform(-3.0, 3.0), rng.uniform(-3.0, 3.0), rng.uniform(-kPi, kPi)};
    EXPECT_GT(expect_marked_as_oracle_says(sweep, pose), 10);
  }
}

TEST(FreeSpace, WholeTurnsOfEvenAnglesAreMarkedWithoutGap) {
  for (const int beams : {8, 90, 360, 361, 720}) {
    const double step_rad = 2.0 * kPi / std::min(beams, 360);  // with more, the turn ends before the beams do
    for (const double start_rad : {-kPi, 0.0, 0.5 * kPi, 1.0}) {
      for (const double sign : {1.0, -1.0}) {
        const Sweep sweep{start_rad, sign * step_rad, std::vector<float>(static_cast<std::size_t>(beams), 2.15F)};
        const double disc_px = kPi * 2.0 * 2.0 / (kFreeRaster.resolution_m * kFreeRaster.resolution_m);
        EXPECT_NEAR(expect_marked_as_oracle_says(sweep, {0.01, 0.02, 0.0}), disc_px, 0.01 * disc_px) << beams;
      }
    }
  }
}

TEST(FreeSpace, WhereverTheLaserStandsEvenOnAPixelsCentreOrOutside) {
  Rng rng(2);
  for (const Pose2& pose :
       {Pose2{0.0, 0.0, 0.0}, Pose2{0.025, 0.025, 0.0}, Pose2{0.025, 0.025, 0.5 * kPi}, Pose2{-4.5, 0.0, 0.0},
        Pose2{4.5, 0.5, kPi}, Pose2{0.5, -4.5, 0.5 * kPi}, Pose2{0.5, 4.5, -0.5 * kPi}, Pose2{3.99, 3.99, -2.0}}) {
    const Sweep sweep{-0.5 * kPi, kPi / 100, std::vector<float>(101, 3.0F)};
    EXPECT_GT(expect_marked_as_oracle_says(sweep, pose), 100);
  }
}

TEST(FreeSpace, BeamsWithoutReturnMarkNothing) {
  const Sweep blind{-1.0, 0.02, {kNothing, 0.0F, std::nanf(""), 31.0F, kNothing, -2.0F, 0.1F}};
  EXPECT_EQ(expect_marked_as_oracle_says(blind, {}), 0);
  Sweep one = blind;
  one.ranges_m[4] = 3.0F;
  EXPECT_GT(expect_marked_as_oracle_says(one, {}), 10);
}

TEST(FreeSpace, NearestOfThreeNeighboursLimitsABeam) {
  std::vector<float> ranges_m(9, 3.0F);
  ranges_m[4] = 1.0F;
  ScoreRaster raster(kFreeRaster);
  const ScanFrame scan = to_scan({-0.4, 0.1, ranges_m});
  raster.mark_free(scan, {}, kMargin_m, kFreePenalty);
  const auto at = [&](int beam, double range_m) {
    return raster.at({range_m * std::cos(scan.angle_rad(beam)), range_m * std::sin(scan.angle_rad(beam))});
  };
  for (const int beam : {3, 4, 5}) {
    EXPECT_LT(at(beam, 0.75), 0.0) << beam;
    EXPECT_EQ(at(beam, 0.95), 0.0) << beam;
  }
  for (const int beam : {1, 2, 6, 7}) {
    EXPECT_LT(at(beam, 2.75), 0.0) << beam;
    EXPECT_EQ(at(beam, 2.95), 0.0) << beam;
  }
}

TEST(FreeSpace, MarkedPixelLosesByTheStatedRuleAndOnceOnly) {
  Rng rng(3);
  Ndt ndt(NdtParams{}, 500);
  ndt.rebuild(random_points(500, 3.0, rng));
  ScoreRaster before(kFreeRaster);
  ScoreRaster after(kFreeRaster);
  before.paint(ndt);
  after.paint(ndt);
  const ScanFrame scan = to_scan({-kPi, kPi / 180, std::vector<float>(360, 2.5F)});
  // The same sweep twice, and a third from elsewhere that overlaps both.
  after.mark_free(scan, {}, kMargin_m, kFreePenalty);
  after.mark_free(scan, {}, kMargin_m, kFreePenalty);
  after.mark_free(scan, {0.5, 0.2, 1.0}, kMargin_m, kFreePenalty);
  int lowered = 0;
  for (int i = 0; i < 2000; ++i) {
    const double angle_rad = rng.uniform(-kPi, kPi);
    const double range_m = rng.uniform(0.1, 2.2);
    const Point2 p{range_m * std::cos(angle_rad), range_m * std::sin(angle_rad)};
    const double n = before.at(p);
    ASSERT_NEAR(after.at(p), n - kFreePenalty * std::max(0.0, 1.0 - 4.0 * n), 0.0011);  // the penalty in 1024ths
    lowered += after.at(p) < n - 0.01 ? 1 : 0;
  }
  EXPECT_GT(lowered, 500);
}

}  // namespace
}  // namespace odoless
