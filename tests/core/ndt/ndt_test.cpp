#include "core/ndt/ndt.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <array>
#include <cmath>
#include <numbers>

#include "core/base/rng.hpp"
#include "tests/core/ndt/plain_ndt.hpp"

namespace odoless {
namespace {

Pose2 random_pose(Rng& rng, double half_side_m) {
  return {rng.uniform(-half_side_m, half_side_m), rng.uniform(-half_side_m, half_side_m), rng.uniform(-3.1, 3.1)};
}

// Near enough for a point set to score on itself.
Pose2 small_pose(Rng& rng) { return {rng.uniform(-0.1, 0.1), rng.uniform(-0.1, 0.1), rng.uniform(-0.02, 0.02)}; }

PointSet moved(const Pose2& new_T_old, const PointSet& points) {
  PointSet out(points.size());
  for (int i = 0; i < points.size(); ++i) {
    out.push_back(new_T_old * points[i]);
  }
  return out;
}

// Halfway between multiples of 2^-10 m: floats hold them exactly, also when moved, and none lies on a cell's border.
PointSet snapped(const PointSet& points) {
  PointSet out(points.size());
  const auto snap = [](double value_m) { return (std::floor(value_m * 1024.0) + 0.5) / 1024.0; };
  for (int i = 0; i < points.size(); ++i) {
    out.push_back({snap(points[i].x_m), snap(points[i].y_m)});
  }
  return out;
}

class NdtOfCellSize : public ::testing::TestWithParam<double> {};

TEST_P(NdtOfCellSize, ScoreEqualsPlainOracle) {
  Rng rng(1);
  NdtParams params;
  params.cell_size_m = GetParam();
  double highest = 0.0;
  for (const double extent_m : {13.0, 16.0, 31.7}) {  // an odd and an even number of cells
    params.extent_m = extent_m;
    Ndt ndt(params, 400);
    for (int round = 0; round < 10; ++round) {
      const PointSet reference = random_points(400, 10.0, rng);
      const PointSet scan = round % 2 == 0 ? random_points(200, 8.0, rng) : reference;
      ndt.rebuild(reference);
      const PlainNdt plain(params, reference);
      for (int i = 0; i < 10; ++i) {
        const Pose2 pose = round % 2 == 0 ? random_pose(rng, 1.0) : small_pose(rng);
        const double expected = plain.score(scan, pose);
        ASSERT_NEAR(ndt.score(scan, pose), expected, 1e-9);
        highest = std::max(highest, expected / scan.size());
      }
    }
  }
  EXPECT_GT(highest, 0.2) << "the oracle was never asked where it matters";
}

TEST_P(NdtOfCellSize, WhatTheWallsHoldEqualsPlainOracle) {
  Rng rng(14);
  const NdtParams params{.cell_size_m = GetParam()};
  const PointSet reference = random_points(300, 5.0, rng);
  const PointSet points = random_points(100, 5.0, rng);
  Ndt ndt(params, 300);
  ndt.rebuild(reference);
  const PlainNdt plain(params, reference);
  for (int i = 0; i < 10; ++i) {
    const Pose2 pose{rng.uniform(-1.0, 1.0), rng.uniform(-1.0, 1.0), rng.uniform(-3.0, 3.0)};
    const Eigen::Matrix3d expected = plain.held(points, pose);
    EXPECT_LT((ndt.derivatives(points, pose).held - expected).norm(), 1e-9 * (1.0 + expected.norm()));
  }
}

TEST_P(NdtOfCellSize, MovingAllByHalfCellsAndQuarterTurnsChangesNoScore) {
  Rng rng(2);
  NdtParams params;
  params.cell_size_m = GetParam();
  Ndt here(params, 300);
  Ndt there(params, 300);
  const double half_cell_m = 0.5 * params.cell_size_m;
  for (int i = 0; i < 20; ++i) {
    const PointSet reference = snapped(random_points(300, 8.0, rng));
    const Pose2 there_T_here{half_cell_m * (rng.below(9) - 4.0), half_cell_m * (rng.below(9) - 4.0),
                             0.5 * std::numbers::pi * rng.below(4)};
    const Pose2 here_T_scan = small_pose(rng);
    here.rebuild(reference);
    there.rebuild(snapped(moved(there_T_here, reference)));
    const double score = here.score(reference, here_T_scan);
    ASSERT_GT(score, 10.0);
    EXPECT_NEAR(there.score(reference, there_T_here * here_T_scan), score, 1e-9);
  }
}

TEST_P(NdtOfCellSize, DerivativesMatchCentralDifferences) {
  Rng rng(3);
  NdtParams params;
  params.cell_size_m = GetParam();
  Ndt ndt(params, 400);
  constexpr double kStep = 1e-6;
  for (int round = 0; round < 20; ++round) {
    const PointSet points = random_points(400, 6.0, rng);
    ndt.rebuild(points);
    const Pose2 pose = small_pose(rng);
    const NdtDerivatives at = ndt.derivatives(points, pose);
    EXPECT_NEAR(at.score, ndt.score(points, pose), 1e-9);
    const double scale = 1.0 + at.gauss_newton.norm();
    for (int k = 0; k < 3; ++k) {
      const auto shifted = [&](double step) {
        return Pose2{pose.x_m + (k == 0 ? step : 0.0), pose.y_m + (k == 1 ? step : 0.0),
                     pose.yaw_rad + (k == 2 ? step : 0.0)};
      };
      const NdtDerivatives up = ndt.derivatives(points, shifted(kStep));
      const NdtDerivatives down = ndt.derivatives(points, shifted(-kStep));
      EXPECT_NEAR((up.score - down.score) / (2.0 * kStep), at.gradient(k), 1e-5 * scale);
      EXPECT_LT(((up.gradient - down.gradient) / (2.0 * kStep) - at.hessian.col(k)).norm(), 1e-5 * scale);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Sizes, NdtOfCellSize, ::testing::Values(0.5, 1.0, 4.0));

TEST(Ndt, DerivativesAreSumsOverThePoints) {
  Rng rng(4);
  Ndt ndt(NdtParams{}, 300);
  const PointSet points = random_points(300, 5.0, rng);
  ndt.rebuild(points);
  const Pose2 pose{0.02, -0.01, 0.01};
  NdtDerivatives sum;
  for (int i = 0; i < points.size(); ++i) {
    PointSet one(1);
    one.push_back(points[i]);
    const NdtDerivatives part = ndt.derivatives(one, pose);
    EXPECT_GE(part.score, 0.0);
    EXPECT_LE(part.score, 1.0);
    sum.score += part.score;
    sum.gradient += part.gradient;
    sum.held += part.held;
    sum.gauss_newton += part.gauss_newton;
  }
  const NdtDerivatives all = ndt.derivatives(points, pose);
  EXPECT_NEAR(all.score, sum.score, 1e-9);
  EXPECT_LT((all.gradient - sum.gradient).norm(), 1e-9 * (1.0 + sum.gauss_newton.norm()));
  EXPECT_LT((all.held - sum.held).norm(), 1e-9 * (1.0 + sum.held.norm()));
  EXPECT_GE(Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(all.gauss_newton).eigenvalues()(0), 0.0);
}

TEST(Ndt, IgnoresPointsOutside) {
  Rng rng(5);
  const NdtParams params{.extent_m = 10.0};
  const PointSet inside = random_points(200, 9.0, rng);
  PointSet with_far(220);
  for (int i = 0; i < 20; ++i) {  // in heaps of twenty, which would make cells
    with_far.push_back({i % 2 == 0 ? 11.6 + 0.01 * i : -1e6, i % 3 == 0 ? 1e9 : 1.0});
  }
  for (int i = 0; i < inside.size(); ++i) {
    with_far.push_back(inside[i]);
  }
  Ndt plain(params, 220);
  Ndt crowded(params, 220);
  plain.rebuild(inside);
  crowded.rebuild(with_far);
  const double score = plain.score(inside, {});
  EXPECT_GT(score, 20.0);
  EXPECT_EQ(crowded.cells().size(), plain.cells().size());
  EXPECT_EQ(crowded.score(inside, {}), score);
  EXPECT_NEAR(plain.score(with_far, {}), score, 1e-9);
  EXPECT_EQ(plain.score(inside, {1e300, 0.0, 0.0}), 0.0);
  EXPECT_EQ(plain.score(inside, {std::nan(""), 0.0, 0.0}), 0.0);
}

// As of foliage or noise, which fill the whole square.
TEST(Ndt, LeavesOutWhatIsInMoreCellsThanItHasRoomFor) {
  constexpr int kSide = 100;
  const NdtParams params{.cell_size_m = 0.5};
  PointSet all(3 * kSide * kSide);
  PointSet first(all.capacity());
  for (int heap = 0; heap < kSide * kSide; ++heap) {
    for (int i = 0; i < 3; ++i) {  // each in four cells of its own, or shared with a neighbour
      const Point2 p{0.5 * (heap % kSide) - 25.0 + 0.02 * i, 0.5 * (heap / kSide) - 25.0 + 0.03 * (i % 2)};
      all.push_back(p);
      if (heap < kSide * kSide / 4) {
        first.push_back(p);
      }
    }
  }
  Ndt full(params, all.capacity());
  Ndt part(params, all.capacity());
  full.rebuild(all);
  part.rebuild(first);
  EXPECT_EQ(full.cells().size(), static_cast<std::size_t>(Ndt::kCells_max));
  EXPECT_LT(part.cells().size(), full.cells().size());
  EXPECT_NEAR(full.score(first, {}), part.score(first, {}), 1e-9 * part.score(first, {}));
}

TEST(Ndt, RebuildingTwiceOrAfterSomethingElseIsRebuildingOnce) {
  Rng rng(6);
  const PointSet first = random_points(300, 9.0, rng);
  const PointSet second = random_points(250, 9.0, rng);
  Ndt fresh(NdtParams{}, 300);
  Ndt reused(NdtParams{}, 300);
  fresh.rebuild(second);
  reused.rebuild(first);
  reused.rebuild(second);
  EXPECT_EQ(reused.score(second, {0.01, 0.0, 0.0}), fresh.score(second, {0.01, 0.0, 0.0}));
  EXPECT_EQ(reused.score(first, {}), fresh.score(first, {}));
  reused.rebuild(second);
  EXPECT_EQ(reused.score(second, {0.01, 0.0, 0.0}), fresh.score(second, {0.01, 0.0, 0.0}));
  reused.rebuild(PointSet(1));
  EXPECT_EQ(reused.score(second, {}), 0.0);
}

TEST(Ndt, CellsNeedTheFewestPoints) {
  PointSet points(6);
  const std::array<Point2, 3> here{Point2{0.6, 0.6}, {0.65, 0.7}, {0.7, 0.62}};
  Ndt ndt(NdtParams{.points_min = 4}, 6);
  for (const Point2& p : here) {
    points.push_back(p);
  }
  ndt.rebuild(points);
  EXPECT_TRUE(ndt.cells().empty());
  points.push_back({0.66, 0.66});
  ndt.rebuild(points);
  EXPECT_EQ(ndt.cells().size(), 4U);
}

// Deviations along the axes of an information matrix, small one first.
Eigen::Vector2d deviations_m(const NdtInformation& b) {
  Eigen::Matrix2d information;
  information << b.xx, b.xy, b.xy, b.yy;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(information);
  return {1.0 / std::sqrt(axes.eigenvalues()(1)), 1.0 / std::sqrt(axes.eigenvalues()(0))};
}

TEST(MendedInformation, HeapOfEqualPointsGetsTheFloorEitherWay) {
  const Eigen::Vector2d sd_m = deviations_m(mended_information(NdtCell{{}, 0.0, 0.0, 0.0, 5}, 0.02, 0.03));
  EXPECT_NEAR(sd_m(0), 0.02, 1e-12);
  EXPECT_NEAR(sd_m(1), 0.02, 1e-12);
}

TEST(MendedInformation, LineInAnyDirectionKeepsItsLengthAndGetsTheFloors) {
  for (int i = 0; i < 36; ++i) {
    const double c = std::cos(i * std::numbers::pi / 36);
    const double s = std::sin(i * std::numbers::pi / 36);
    for (const double length_m : {0.001, 0.3, 2.0}) {
      const double variance_m2 = length_m * length_m;
      const NdtCell line{{}, variance_m2 * c * c, variance_m2 * c * s, variance_m2 * s * s, 9};
      const NdtInformation b = mended_information(line, 0.02, 0.1);
      const Eigen::Vector2d sd_m = deviations_m(b);
      EXPECT_NEAR(sd_m(1), std::max(0.02, length_m), 1e-9);
      EXPECT_NEAR(sd_m(0), std::max(0.02, 0.1 * sd_m(1)), 1e-9);
      const double along = b.xx * c * c + 2.0 * b.xy * c * s + b.yy * s * s;
      EXPECT_NEAR(along, 1.0 / (sd_m(1) * sd_m(1)), 1e-6 * along);
    }
  }
}

TEST(MendedInformation, RegularCovarianceIsInverted) {
  Rng rng(7);
  for (int i = 0; i < 200; ++i) {
    const double x_m = rng.uniform(0.1, 1.0);
    const double y_m = rng.uniform(0.1, 1.0);
    const double xy_m2 = rng.uniform(-0.5, 0.5) * x_m * y_m;
    const NdtInformation b = mended_information(NdtCell{{}, x_m * x_m, xy_m2, y_m * y_m, 9}, 0.01, 0.01);
    EXPECT_NEAR(b.xx * x_m * x_m + b.xy * xy_m2, 1.0, 1e-9);
    EXPECT_NEAR(b.xx * xy_m2 + b.xy * y_m * y_m, 0.0, 1e-9);
    EXPECT_NEAR(b.xy * xy_m2 + b.yy * y_m * y_m, 1.0, 1e-9);
  }
}

TEST(Ndt, SingularCellsAreFiniteAndTheirMeanScoresAWholePoint) {
  for (const double spacing_m : {0.0, 0.05}) {
    PointSet points(9);
    for (int i = -4; i <= 4; ++i) {
      points.push_back({0.375 + spacing_m * i * 0.5, 0.375 - spacing_m * i * 0.25});
    }
    Ndt ndt(NdtParams{}, 9);
    ndt.rebuild(points);
    ASSERT_EQ(ndt.cells().size(), 4U);
    PointSet mean(1);
    mean.push_back({0.375, 0.375});
    EXPECT_NEAR(ndt.score(mean, {}), 1.0, 1e-6);
    const NdtDerivatives beside = ndt.derivatives(mean, {0.01, 0.01, 0.0});
    EXPECT_TRUE(beside.hessian.allFinite());
    EXPECT_LT(beside.gradient(0), 0.0);
    EXPECT_LT(beside.gradient(1), 0.0);
  }
}

}  // namespace
}  // namespace odoless
