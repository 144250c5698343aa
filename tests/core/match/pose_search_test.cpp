// The parts of a search for a pose: what is expected, the best few answers, and the angles that surfaces propose.
#include "core/match/pose_search.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/math/elementary.hpp"

namespace odoless {
namespace {

constexpr double kBin_rad = OrientationHistogram::kBin_rad;

TEST(MotionPrior, NothingIsLostWithinADeviationAndTheLogarithmOfItsSquareBeyond) {
  const MotionPrior prior{{1.0, 2.0, 3.0}, 0.5, 0.1, 2.0};
  EXPECT_EQ(prior.penalty({1.0, 2.0, 3.0}), 0.0);
  EXPECT_EQ(prior.penalty({1.49, 2.0, 3.0}), 0.0);
  EXPECT_NEAR(prior.penalty({2.0, 2.0, 3.0}), 2.0 * std::log(4.0), 1e-12);
  EXPECT_NEAR(prior.penalty({1.0, 1.0, 3.0}), 2.0 * std::log(4.0), 1e-12);
  EXPECT_NEAR(prior.penalty({1.0, 2.0, 3.3}), 2.0 * std::log(9.0), 1e-12);
  EXPECT_NEAR(prior.penalty({2.0, 3.0, 3.2}), 2.0 * std::log(12.0), 1e-12);
  EXPECT_NEAR(prior.penalty({1.0, 2.0, 3.0 + 2.0 * std::numbers::pi}), 0.0, 1e-12) << "a whole turn";
}

TEST(MotionPrior, WithoutADeviationAllIsAsGood) {
  EXPECT_EQ((MotionPrior{{}, 0.0, 0.1, 2.0}).penalty({9.0, 9.0, 3.0}), 0.0);
  EXPECT_EQ((MotionPrior{{}, 0.1, 0.0, 2.0}).penalty({9.0, 9.0, 3.0}), 0.0);
}

TEST(SearchAnswers, AreApartByMoreThanTheirNoise) {
  const SearchPoint at{1.0, 1.0, 3.1};
  EXPECT_FALSE(clearly_apart(at, {1.27, 1.27, 3.1}));
  EXPECT_TRUE(clearly_apart(at, {1.29, 1.29, 3.1}));
  EXPECT_FALSE(clearly_apart(at, {1.0, 1.0, 2.91}));
  EXPECT_TRUE(clearly_apart(at, {1.0, 1.0, 2.89}));
  EXPECT_FALSE(clearly_apart(at, {1.0, 1.0, -3.1})) << "0.08 rad, over the back";
}

TEST(Peaks, KeepTheBestOfEachPlaceBestFirst) {
  Peaks peaks;
  EXPECT_TRUE(peaks.is_apart({}));
  for (const auto& [x_m, score] : {std::pair{0.0, 0.5}, {3.0, 0.7}, {0.1, 0.6}, {3.1, 0.4}, {6.0, 0.1}}) {
    peaks.offer({{x_m, 0.0, 0.0}, score});
  }
  ASSERT_EQ(peaks.size(), 3U);
  EXPECT_EQ(peaks.best().point[0], 3.0);
  EXPECT_EQ(peaks.all()[1].point[0], 0.1) << "better than the one at 0";
  EXPECT_EQ(peaks.all()[2].score, 0.1);
  EXPECT_FALSE(peaks.is_apart({6.2, 0.0, 0.0}));
  EXPECT_TRUE(peaks.is_apart({8.0, 0.0, 0.0}));
}

TEST(Peaks, OfManyKeepTheBest) {
  Peaks peaks;
  for (const int i : {3, 7, 1, 5, 6, 2, 4, 0}) {
    peaks.offer({{static_cast<double>(i), 0.0, 0.0}, 0.1 * i});
  }
  ASSERT_EQ(peaks.size(), Peaks::kMost);
  for (std::size_t i = 0; i < peaks.size(); ++i) {
    EXPECT_EQ(peaks.all()[i].point[0], 7.0 - static_cast<double>(i));
  }
}

/// A scan of a wall to the left, 2 m away and along the robot's way, or turned by so much.
ScanFrame wall(double turned_rad) {
  constexpr int kWallBeams = 181;
  constexpr double kWallStep_rad = std::numbers::pi / 180.0;
  std::vector<float> ranges_m;
  for (int i = 0; i < kWallBeams; ++i) {
    const double angle_rad = (i - kWallBeams / 2) * kWallStep_rad + 0.5 * std::numbers::pi;
    const double to_wall = std::sin(angle_rad - turned_rad);
    ranges_m.push_back(to_wall > 0.2 ? static_cast<float>(2.0 / to_wall) : 100.0F);
  }
  ScanFrame scan(ScanParams{});
  EXPECT_EQ(scan.assign({.start_angle_rad = -(kWallBeams / 2) * kWallStep_rad + 0.5 * std::numbers::pi,
                         .angle_step_rad = kWallStep_rad,
                         .ranges_m = ranges_m}),
            Errc::kOk);
  return scan;
}

OrientationHistogram histogram_of(const ScanFrame& scan, double yaw_rad) {
  OrientationHistogram out;
  out.clear();
  out.add(scan, yaw_rad, 0.1);
  out.smooth();
  return out;
}

int best_shift(const OrientationHistogram& a, const OrientationHistogram& b) {
  int best = 0;
  for (int shift = 1; shift < static_cast<int>(OrientationHistogram::kBins); ++shift) {
    best = a.correlation(b, shift) > a.correlation(b, best) ? shift : best;
  }
  return best;
}

// [weiss1994orientation]
TEST(OrientationHistogram, IsShiftedByTheAngleBetweenTwoScans) {
  const OrientationHistogram straight = histogram_of(wall(0.0), 0.0);
  const OrientationHistogram turned = histogram_of(wall(0.0), 20.0 * kBin_rad);
  EXPECT_EQ(best_shift(turned, straight), 20);
  EXPECT_EQ(best_shift(straight, turned), 180 - 20);
  EXPECT_EQ(straight.correlation(straight, 0), straight.correlation(straight, 180)) << "a whole turn";
  EXPECT_EQ(straight.correlation(turned, -20), turned.correlation(straight, 20));
  const OrientationHistogram seen = histogram_of(wall(10.0 * kBin_rad), 0.0);
  EXPECT_NEAR(best_shift(seen, straight), 10, 1);
}

TEST(OrientationHistogram, CountsLengthsAndNothingAcrossGaps) {
  OrientationHistogram one = histogram_of(wall(0.0), 0.0);
  OrientationHistogram empty;
  empty.clear();
  EXPECT_EQ(one.correlation(empty, 0), 0.0);
  OrientationHistogram twice;
  twice.clear();
  twice.add(wall(0.0), 0.0, 0.1);
  twice.add(wall(0.0), 0.0, 0.1);
  twice.smooth();
  EXPECT_NEAR(twice.correlation(one, 0), 2.0 * one.correlation(one, 0), 1e-3 * one.correlation(one, 0));
  ScanFrame apart(ScanParams{});  // two returns, a metre from each other
  const std::vector<float> ranges_m{2.0F, 3.0F};
  ASSERT_EQ(apart.assign({.start_angle_rad = 0.0, .angle_step_rad = 0.01, .ranges_m = ranges_m}), Errc::kOk);
  EXPECT_EQ(histogram_of(apart, 0.0).correlation(one, 0), 0.0);
}

TEST(AngleProposal, DrawsWhereHistogramsFitAndSomewhatEverywhere) {
  const OrientationHistogram straight = histogram_of(wall(0.0), 0.0);
  const OrientationHistogram turned = histogram_of(wall(0.0), 0.25);
  AngleProposal angles;
  constexpr double kHalf_rad = 0.6;
  angles.rebuild(turned, straight, 0.1, kHalf_rad, 0.3);
  constexpr int kDrawn = 1000;
  int near = 0;
  double before_rad = -10.0;
  for (int i = 0; i < kDrawn; ++i) {
    const double offset_rad = angles.offset_rad((i + 0.5) / kDrawn);
    EXPECT_GE(offset_rad, before_rad) << "grows with the fraction";
    EXPECT_LE(std::abs(offset_rad), kHalf_rad + 1.5 * kBin_rad);
    before_rad = offset_rad;
    near += std::abs(offset_rad - 0.15) < 0.1 ? 1 : 0;
  }
  EXPECT_GT(near, kDrawn / 2);
  EXPECT_LT(near, kDrawn * 9 / 10);
  EXPECT_LT(angles.offset_rad(0.0), -kHalf_rad + 2.0 * kBin_rad);
  EXPECT_GT(angles.offset_rad(1.0), kHalf_rad - 2.0 * kBin_rad);
}

TEST(AngleProposal, OfNothingDrawsEvenly) {
  OrientationHistogram empty;
  empty.clear();
  AngleProposal angles;
  angles.rebuild(empty, empty, 0.0, 0.6, 0.3);
  for (const double fraction : {0.1, 0.25, 0.5, 0.75, 0.9}) {
    EXPECT_NEAR(angles.offset_rad(fraction), (2.0 * fraction - 1.0) * 0.6, 1.5 * kBin_rad);
  }
}

}  // namespace
}  // namespace odoless
