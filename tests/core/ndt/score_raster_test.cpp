#include "core/ndt/score_raster.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/base/rng.hpp"
#include "tests/core/ndt/plain_ndt.hpp"

namespace odoless {
namespace {

constexpr RasterParams kRaster{.resolution_m = 0.05, .extent_m = 6.0, .sigma_min_m = 0.05};

// (1 - t/32)^32 is at most 0.0087 below exp(-t); beyond 3.7 deviations a Gaussian (0.0011) is left out; four grids
// round down by 2 of 16384 each.
constexpr double kApproximation = 0.0087 + 4 * 2.0 / ScoreRaster::kUnit;

class ScoreRasterOfCellSize : public ::testing::TestWithParam<double> {};

TEST_P(ScoreRasterOfCellSize, PixelCentresHoldTheScore) {
  Rng rng(1);
  const NdtParams params{.cell_size_m = GetParam(), .sigma_min_m = kRaster.sigma_min_m};
  const PointSet reference = random_points(500, 5.0, rng);
  Ndt ndt(params, 500);
  ndt.rebuild(reference);
  ScoreRaster raster(kRaster);
  raster.paint(ndt);
  const PlainNdt plain(params, reference);
  double highest = 0.0;
  double worst = 0.0;
  for (int column = -118; column < 118; ++column) {
    for (int row = -118; row < 118; ++row) {
      const Point2 centre{(column + 0.5) * kRaster.resolution_m, (row + 0.5) * kRaster.resolution_m};
      const double exact = plain.point_score(centre);
      worst = std::max(worst, std::abs(raster.at(centre) - exact));
      highest = std::max(highest, exact);
    }
  }
  EXPECT_LT(worst, kApproximation);
  EXPECT_GT(highest, 0.8);
}

INSTANTIATE_TEST_SUITE_P(Sizes, ScoreRasterOfCellSize, ::testing::Values(0.5, 1.0, 4.0));

TEST(ScoreRaster, BlursToItsOwnSmallestDeviation) {
  Rng rng(2);
  const PointSet reference = random_points(500, 5.0, rng);
  Ndt sharp(NdtParams{}, 500);
  sharp.rebuild(reference);
  ScoreRaster raster({.resolution_m = 0.05, .extent_m = 6.0, .sigma_min_m = 0.3});
  raster.paint(sharp);
  const PlainNdt blurred(NdtParams{.sigma_min_m = 0.3}, reference);
  for (int i = 0; i < 1000; ++i) {
    const Point2 centre{(rng.below(200) - 99.5) * 0.05, (rng.below(200) - 99.5) * 0.05};
    ASSERT_NEAR(raster.at(centre), blurred.point_score(centre), kApproximation);
  }
}

TEST(ScoreRaster, ScoreIsTheSumOfItsPixels) {
  Rng rng(3);
  Ndt ndt(NdtParams{}, 500);
  ndt.rebuild(random_points(500, 5.0, rng));
  ScoreRaster raster(kRaster);
  raster.paint(ndt);
  for (int round = 0; round < 50; ++round) {
    const Pose2 pose{rng.uniform(-2.0, 2.0), rng.uniform(-2.0, 2.0), rng.uniform(-3.0, 3.0)};
    const PointSet candidates = random_points(500, 7.0, rng);  // some lie beyond the raster
    PointSet points(500);
    double sum = 0.0;
    for (int i = 0; i < candidates.size(); ++i) {
      const Point2 p = pose * candidates[i];
      const double from_border_px = std::min(std::abs(std::remainder(p.x_m / kRaster.resolution_m, 1.0)),
                                             std::abs(std::remainder(p.y_m / kRaster.resolution_m, 1.0)));
      if (from_border_px > 1e-3) {  // nearer, rounding to float may choose either pixel
        points.push_back(candidates[i]);
        sum += raster.at(p);
      }
    }
    ASSERT_GT(points.size(), 450);
    ASSERT_NEAR(raster.score(points.x_m(), points.y_m(), pose), sum, 1e-12);
  }
}

TEST(ScoreRaster, PointsBeyondItScoreNothing) {
  Rng rng(4);
  Ndt ndt(NdtParams{}, 2000);
  ndt.rebuild(random_points(2000, 12.0, rng));
  ScoreRaster raster(kRaster);
  raster.paint(ndt);
  for (const double far_m : {6.2, 10.0, 1e3, 1e9, 1e30}) {
    for (double along_m = -6.0; along_m <= 6.0; along_m += 0.05) {
      EXPECT_EQ(raster.at({far_m, along_m}), 0.0);
      EXPECT_EQ(raster.at({-far_m, along_m}), 0.0);
      EXPECT_EQ(raster.at({along_m, far_m}), 0.0);
      EXPECT_EQ(raster.at({along_m, -far_m}), 0.0);
    }
  }
  EXPECT_EQ(raster.score({}, {}, {}), 0.0);
}

TEST(ScoreRaster, PaintingAgainForgetsTheOldPicture) {
  Rng rng(5);
  const PointSet old = random_points(500, 5.0, rng);
  const PointSet now = random_points(500, 5.0, rng);
  Ndt ndt(NdtParams{}, 500);
  ScoreRaster fresh(kRaster);
  ScoreRaster reused(kRaster);
  ndt.rebuild(old);
  reused.paint(ndt);
  ndt.rebuild(now);
  reused.paint(ndt);
  fresh.paint(ndt);
  for (int i = 0; i < old.size(); ++i) {
    EXPECT_EQ(reused.at(old[i]), fresh.at(old[i]));
  }
}

// From pixel centre to pixel centre: the highest Gaussian of all points, and what is free away from them is penalised.
TEST(ScoreRaster, OfAMapHoldsTheNearestPointsGaussianAndItsFreeSpace) {
  constexpr double kFar_m = 3.0;
  constexpr double kPenalty = 0.6;
  const RasterParams params{.resolution_m = 0.1, .extent_m = kFar_m, .sigma_min_m = 0.2};
  ScoreRaster raster(params);
  Rng rng(6);
  const PointSet points = random_points(20, kFar_m, rng);
  for (int i = 0; i < points.size(); ++i) {
    raster.stamp(points[i]);
  }
  raster.stamp({1e30, 0.0});  // far away: nothing happens
  for (int row = -29; row < 29; ++row) {
    for (int column = -29; column < 29; ++column) {
      const Point2 p{(column + 0.5) * params.resolution_m, (row + 0.5) * params.resolution_m};
      double nearest_m = 1e9;
      for (int i = 0; i < points.size(); ++i) {
        nearest_m = std::min(nearest_m, std::hypot(p.x_m - points[i].x_m, p.y_m - points[i].y_m));
      }
      const double sigmas = nearest_m / params.sigma_min_m;
      const double expected = std::exp(-0.5 * sigmas * sigmas);
      EXPECT_NEAR(raster.at(p), expected, 0.012) << p.x_m << " " << p.y_m;
      EXPECT_FALSE(raster.is_free(p));
      const double before = raster.at(p);
      raster.mark_free(p, kPenalty);
      raster.mark_free(p, kPenalty);  // twice is once
      EXPECT_TRUE(raster.is_free(p));
      EXPECT_NEAR(raster.at(p), before - kPenalty * std::max(0.0, 1.0 - 4.0 * before), 0.002);
    }
  }
  raster.clear();
  EXPECT_EQ(raster.at(points[0]), 0.0);
}

}  // namespace
}  // namespace odoless
