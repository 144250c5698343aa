#include "core/match/ndt_matcher.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <string>

#include "tests/core/match/match_support.hpp"

namespace odoless {
namespace {

/// The information along a corridor is that of a ripple of the cells' Gaussians, the more the smaller they are.
struct CellCase {
  double cell_size_m;
  double weak_1_m2;  ///< more than along a corridor, and less than a tenth of what a room has
};

class NdtMatcherWithCells : public ::testing::TestWithParam<CellCase> {
 protected:
  static MatcherParams params() {
    MatcherParams out;
    out.reference.ndt.cell_size_m = GetParam().cell_size_m;
    return out;
  }
};

INSTANTIATE_TEST_SUITE_P(Cells, NdtMatcherWithCells,
                         ::testing::Values(CellCase{1.0, 15.0},
                                           CellCase{MatcherParams{}.reference.ndt.cell_size_m, 20.0}),
                         [](const auto& tested) {
                           return std::to_string(std::lround(1000.0 * tested.param.cell_size_m)) + "mm";
                         });

TEST(NdtMatcher, RecoversMotionsInTheBox) {
  const SimulatedScene room = cluttered_room();
  Rng rng(1);
  MatchBench bench;
  int right = 0;
  for (int i = 0; i < 100; ++i) {
    const ScanPair pair = random_pair(room, {}, {}, rng);
    const MatchResult result = bench.match(pair.reference, pair.scan);
    right += agree(result.reference_T_scan, pair.reference_T_scan) ? 1 : 0;
    EXPECT_TRUE(result.converged || !agree(result.reference_T_scan, pair.reference_T_scan) || result.peak_count > 1)
        << i;
    EXPECT_GE(result.fitness, 0.0);
    EXPECT_LE(result.fitness, 1.0);
  }
  EXPECT_GE(right, 99);
}

// What the search maximises: the mean of the fine raster over the scan's thinned points.
TEST(NdtMatcher, ScoresNoLowerThanAnExhaustiveSearchOfItsBox) {
  const SimulatedScene room = cluttered_room();
  const MatcherParams params;
  Rng rng(2);
  MatchBench bench(params);
  for (int round = 0; round < 6; ++round) {
    const ScanPair pair = random_pair(room, {}, {}, rng);
    const MatchResult result = bench.match(pair.reference, pair.scan);
    PointSet points(params.points_max);
    append_thinned(pair.scan, {}, params.reference.thinning_m, points);
    double highest = 0.0;
    for (double x_m = -2.0; x_m <= 2.0; x_m += 0.1) {
      for (double y_m = -2.0; y_m <= 2.0; y_m += 0.1) {
        for (double yaw_deg = -84.0; yaw_deg <= 84.0; yaw_deg += 2.0) {
          const Pose2 pose{x_m, y_m, yaw_deg * kRadPerDeg};
          highest = std::max(highest, bench.reference().fine().score(points.x_m(), points.y_m(), pose));
        }
      }
    }
    EXPECT_GE(result.score, highest / points.size() - 0.005);
    EXPECT_GT(result.score, 0.3);
  }
}

TEST(NdtMatcher, ScanOfAnotherPlaceIsTriedAgainAndNotConverged) {
  Rng rng(3);
  MatchBench bench;
  for (int i = 0; i < 10; ++i) {
    const SimulatedScene room = cluttered_room();
    const ScanFrame here = sweep(room, {}, random_free_pose(room, rng), rng);
    const ScanFrame elsewhere = sweep(pillar_field(), {}, {0.0, 0.0, rng.uniform(-3.0, 3.0)}, rng);
    const MatchResult result = bench.match(here, elsewhere);
    EXPECT_TRUE(result.escalated);
    EXPECT_FALSE(result.converged);
    EXPECT_LT(result.fitness, 0.4);
  }
}

TEST(NdtMatcher, WiderSearchFindsWhatLiesBeyondTheBoxAndSaysSo) {
  const SimulatedScene room = cluttered_room();
  const SimulatedLaser all_round{
      .beams = 480, .start_angle_rad = -std::numbers::pi, .angle_step_rad = std::numbers::pi / 240};
  Rng rng(4);
  MatchBench bench;
  const MotionBounds far{.half_m = 4.0, .half_rad = std::numbers::pi, .least_m = 3.0};
  const MotionBounds turned{.half_rad = 151.0 * kRadPerDeg, .least_rad = 149.0 * kRadPerDeg};
  int right = 0;
  for (int i = 0; i < 20; ++i) {
    const ScanPair pair = random_pair(room, all_round, i % 2 == 0 ? far : turned, rng);
    const MatchResult result = bench.match(pair.reference, pair.scan);
    EXPECT_TRUE(result.escalated || !agree(result.reference_T_scan, pair.reference_T_scan));
    right += result.escalated && result.converged && agree(result.reference_T_scan, pair.reference_T_scan) ? 1 : 0;
  }
  EXPECT_GE(right, 18);
}

TEST_P(NdtMatcherWithCells, CorridorIsWeakAlongItself) {
  Rng rng(5);
  MatchBench bench(params());
  const SimulatedLaser laser{.range_max_m = 8.0};
  for (int i = 0; i < 10; ++i) {
    const double yaw_rad = rng.uniform(-3.0, 3.0);
    const Pose2 map_T_reference{0.0, rng.uniform(-0.4, 0.4), yaw_rad};
    const Pose2 map_T_scan{0.3, rng.uniform(-0.4, 0.4), yaw_rad + rng.uniform(-0.3, 0.3)};
    const MatchResult result =
        bench.match(sweep(corridor(), laser, map_T_reference, rng), sweep(corridor(), laser, map_T_scan, rng));
    // Along the corridor, seen in the reference's axes; either way round.
    const Eigen::Vector2d along(std::cos(yaw_rad), -std::sin(yaw_rad));
    const Eigen::Vector2d across(-along.y(), along.x());
    EXPECT_GT(std::abs(result.weak_direction.x_m * along.x() + result.weak_direction.y_m * along.y()), 0.99);
    const Eigen::Matrix2d covariance = result.covariance.topLeftCorner<2, 2>();
    const double sd_along_m = std::sqrt(along.dot(covariance * along));
    const double sd_across_m = std::sqrt(across.dot(covariance * across));
    EXPECT_GT(sd_along_m, 5.0 * sd_across_m);
    EXPECT_GT(result.peak_count, 1) << "any place along it is as good";
    EXPECT_LT(std::abs(result.weak_information_1_m2), GetParam().weak_1_m2);
    const Pose2 truth = map_T_reference.inverse() * map_T_scan;
    const Eigen::Vector2d error(result.reference_T_scan.x_m - truth.x_m, result.reference_T_scan.y_m - truth.y_m);
    EXPECT_LT(std::abs(across.dot(error)), 0.02);
    EXPECT_LT(rotation_error_rad(result.reference_T_scan, truth), 0.5 * kRadPerDeg);
  }
}

TEST_P(NdtMatcherWithCells, RoomIsHeldEveryWay) {
  const SimulatedScene room = cluttered_room();
  Rng rng(6);
  MatchBench bench(params());
  for (int i = 0; i < 10; ++i) {
    const ScanPair pair = random_pair(room, {}, {.half_m = 1.0, .half_rad = 0.5}, rng);
    const MatchResult result = bench.match(pair.reference, pair.scan);
    EXPECT_GT(result.weak_information_1_m2, 10.0 * GetParam().weak_1_m2);
    EXPECT_NEAR(std::hypot(result.weak_direction.x_m, result.weak_direction.y_m), 1.0, 1e-9);
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(result.covariance);
    EXPECT_GT(axes.eigenvalues()(0), 0.0);
    EXPECT_LT(std::sqrt(axes.eigenvalues()(2)), 0.02);
  }
}

TEST(NdtMatcher, ExpectationBeyondTheBoxMovesTheBox) {
  const SimulatedScene room = cluttered_room();
  Rng rng(7);
  MatchBench bench;
  for (int i = 0; i < 10; ++i) {
    const ScanPair pair = random_pair(room, {}, {.half_m = 4.0, .half_rad = 2.0, .least_m = 2.9}, rng);
    Pose2 expected = pair.reference_T_scan;
    expected.x_m += rng.uniform(-0.5, 0.5);
    expected.yaw_rad += rng.uniform(-0.5, 0.5);
    const MatchResult result = bench.match(pair.reference, pair.scan, {}, {expected, 0.5, 0.5});
    EXPECT_TRUE(agree(result.reference_T_scan, pair.reference_T_scan)) << i;
  }
}

TEST(NdtMatcher, SaysWhyItCannotMatch) {
  Rng rng(8);
  MatchBench bench;
  const ScanFrame scan = sweep(cluttered_room(), {}, {}, rng);
  const ScanFrame blind = sweep(SimulatedScene{}, {}, {}, rng);
  EXPECT_EQ(bench.match(scan).error(), Errc::kNoReference);
  const PlacedScan nothing{&blind, {}};
  EXPECT_EQ(bench.reference().rebuild({&nothing, 1}), Errc::kTooFewReturns);
  EXPECT_TRUE(bench.reference().empty());
  EXPECT_EQ(bench.match(scan).error(), Errc::kNoReference);
  const PlacedScan placed{&scan, {}};
  ASSERT_EQ(bench.reference().rebuild({&placed, 1}), Errc::kOk);
  EXPECT_EQ(bench.match(blind).error(), Errc::kTooFewReturns);
  EXPECT_TRUE(bench.match(scan).ok());
  MatchBench small(MatcherParams{.points_max = 360});
  ASSERT_EQ(small.reference().rebuild({&placed, 1}), Errc::kOk);
  EXPECT_EQ(small.match(scan).error(), Errc::kTooManyBeams);
}

TEST(NdtMatcher, DeadlineAlreadyOverStillGivesAnAnswer) {
  const SimulatedScene room = cluttered_room();
  Rng rng(9);
  MatchBench bench;
  const ScanPair pair = random_pair(room, {}, {.half_m = 0.3, .half_rad = 0.1}, rng);
  const MatchResult in_time = bench.match(pair.reference, pair.scan);
  EXPECT_EQ(in_time.stop, StopReason::kBudget);
  const Deadline over([](const void*) { return true; }, nullptr);
  const MatchResult late = bench.match(pair.scan, {}, over).value();
  EXPECT_EQ(late.stop, StopReason::kDeadline);
  EXPECT_LT(late.evaluations, in_time.evaluations / 2);
  EXPECT_GT(late.evaluations, 0);
  EXPECT_TRUE(late.covariance.allFinite());
  EXPECT_TRUE(agree(late.reference_T_scan, pair.reference_T_scan)) << "so near, the first candidates hold it";
  const MatchResult lost = bench.match(sweep(pillar_field(), {}, {}, rng), {}, over).value();
  EXPECT_EQ(lost.stop, StopReason::kDeadline);
  EXPECT_FALSE(lost.converged);
  EXPECT_FALSE(lost.escalated) << "there is no time for it";
}

// Wherever it falls: before the search, in it, in the simplexes, in the Newton steps, between the two tries.
TEST(NdtMatcher, AfterTheDeadlineThereIsOnlyWhatAnAnswerNeeds) {
  // Start points of the second try, population, simplexes, Newton steps; and between two questions.
  constexpr int kAnswer = 800 + 80 + 64 + 3 * 4 + 4 + 40;
  const SimulatedScene room = cluttered_room();
  Rng rng(11);
  const ScanFrame here = sweep(room, {}, {}, rng);
  const ScanFrame elsewhere = sweep(pillar_field(), {}, {}, rng);
  const PlacedScan placed{&here, {}};
  struct Questions {
    int left = 0;
    int asked = 0;
  };
  const auto is_over = [](const void* context) {
    auto& questions = *static_cast<Questions*>(const_cast<void*>(context));
    return ++questions.asked > questions.left;
  };
  int before = 0;
  for (int left = 0; left < 1000; left += 7) {
    MatchBench bench;  // each the same
    ASSERT_EQ(bench.reference().rebuild({&placed, 1}), Errc::kOk);
    Questions questions{.left = left};
    const MatchResult result = bench.match(elsewhere, {}, Deadline(is_over, &questions)).value();
    EXPECT_LE(result.evaluations, before + kAnswer) << left;
    EXPECT_TRUE(result.covariance.allFinite());
    if (questions.asked <= left) {
      EXPECT_GT(left, 200);
      return;  // it never was over
    }
    before = result.evaluations;
  }
  FAIL() << "asks for ever";
}

TEST(NdtMatcher, SameSeedSameBits) {
  const SimulatedScene room = cluttered_room();
  Rng rng(10);
  MatchBench used;
  for (int i = 0; i < 10; ++i) {
    const ScanPair pair = random_pair(room, {}, {.half_rad = 1.4}, rng);
    static_cast<void>(used.match(pair.scan, pair.reference));
    MatchBench one({}, 5);
    MatchBench two({}, 5);
    static_cast<void>(two.match(pair.scan, pair.scan));
    two = MatchBench({}, 5);
    const MatchResult a = one.match(pair.reference, pair.scan);
    const MatchResult b = two.match(pair.reference, pair.scan);
    EXPECT_EQ(a.reference_T_scan.x_m, b.reference_T_scan.x_m);
    EXPECT_EQ(a.reference_T_scan.y_m, b.reference_T_scan.y_m);
    EXPECT_EQ(a.reference_T_scan.yaw_rad, b.reference_T_scan.yaw_rad);
    EXPECT_EQ(a.fitness, b.fitness);
    EXPECT_EQ(a.evaluations, b.evaluations);
    EXPECT_EQ(a.covariance, b.covariance);
  }
}

}  // namespace
}  // namespace odoless
