#include "core/match/match_reference.hpp"

#include <gtest/gtest.h>

#include <array>

#include "tests/core/match/match_support.hpp"

namespace odoless {
namespace {

// Sum over a lattice of what both rasters and the exact NDT say.
std::array<double, 3> fingerprint(const MatchReference& reference) {
  PointSet lattice(10000);
  for (int i = 0; i < lattice.capacity(); ++i) {
    lattice.push_back({0.1 * (i % 100) - 5.0, 0.1 * (i / 100) - 5.0});
  }
  return {reference.fine().score(lattice.x_m(), lattice.y_m(), {}),
          reference.coarse().score(lattice.x_m(), lattice.y_m(), {}), reference.exact_ndt().score(lattice, {})};
}

class MatchReferenceTest : public ::testing::Test {
 protected:
  Rng rng_{1};
  SimulatedScene room_ = cluttered_room();
  Pose2 second_pose_{1.0, 0.5, 1.0};
  ScanFrame first_ = sweep(room_, {}, {}, rng_);
  ScanFrame second_ = sweep(room_, {}, second_pose_, rng_);
};

TEST_F(MatchReferenceTest, RebuildingForgetsTheOldOne) {
  MatchReference fresh({}, 1000);
  MatchReference reused({}, 1000);
  const PlacedScan old{&first_, {}};
  const PlacedScan now{&second_, second_pose_};
  ASSERT_EQ(reused.rebuild({&old, 1}), Errc::kOk);
  ASSERT_EQ(reused.rebuild({&now, 1}), Errc::kOk);
  ASSERT_EQ(fresh.rebuild({&now, 1}), Errc::kOk);
  EXPECT_EQ(fingerprint(reused), fingerprint(fresh));
}

TEST_F(MatchReferenceTest, SlicesMakeTheSame) {
  const std::array<PlacedScan, 2> both{PlacedScan{&second_, second_pose_}, PlacedScan{&first_, {}}};
  MatchReference whole({}, 1000);
  MatchReference sliced({}, 1000);
  ASSERT_EQ(whole.rebuild(both), Errc::kOk);
  sliced.begin_rebuild(both);
  for (int i = 0; i < 10; ++i) {
    ASSERT_FALSE(sliced.rebuild_slice());
  }
  sliced.begin_rebuild(both);  // anew, in the middle of the last
  int slices = 1;
  for (; !sliced.rebuild_slice(); ++slices) {
  }
  EXPECT_GT(slices, 10);
  EXPECT_EQ(fingerprint(sliced), fingerprint(whole));
}

TEST_F(MatchReferenceTest, WideRasterIsPaintedUntilTheDeadlineAndThenGoneOnWith) {
  MatchReference whole({}, 1000);
  MatchReference sliced({}, 1000);
  const PlacedScan placed{&first_, {}};
  ASSERT_EQ(whole.rebuild({&placed, 1}), Errc::kOk);
  ASSERT_EQ(sliced.rebuild({&placed, 1}), Errc::kOk);
  int calls = 0;
  for (bool ready = false; !ready; ++calls) {
    int questions = 0;
    const Deadline second_question([](const void* asked) { return ++*static_cast<int*>(const_cast<void*>(asked)) > 1; },
                                   &questions);
    ready = sliced.prepare_wide(second_question);
  }
  EXPECT_GE(calls, 3);
  PointSet points(1000);
  append_thinned(second_, second_pose_, 0.0, points);
  EXPECT_EQ(sliced.wide().score(points.x_m(), points.y_m(), {}), whole.wide().score(points.x_m(), points.y_m(), {}));
}

TEST_F(MatchReferenceTest, WhatDoesNotFitIsTheOldestWithAllThatItSaid) {
  const std::array<PlacedScan, 2> both{PlacedScan{&second_, second_pose_}, PlacedScan{&first_, {}}};
  MatchReference small({}, second_.returns() + first_.returns() - 1);
  MatchReference newest_alone({}, 1000);
  MatchReference large({}, 1000);
  ASSERT_EQ(small.rebuild(both), Errc::kOk);
  ASSERT_EQ(newest_alone.rebuild({both.data(), 1}), Errc::kOk);
  ASSERT_EQ(large.rebuild(both), Errc::kOk);
  EXPECT_EQ(fingerprint(small), fingerprint(newest_alone));
  EXPECT_NE(fingerprint(large), fingerprint(newest_alone));
}

TEST_F(MatchReferenceTest, OwnPointsScoreHighInEveryForm) {
  MatchReference reference({}, 1000);
  const PlacedScan placed{&first_, {}};
  ASSERT_EQ(reference.rebuild({&placed, 1}), Errc::kOk);
  PointSet points(1000);
  append_thinned(first_, {}, 0.0, points);
  EXPECT_GT(reference.exact_ndt().score(points, {}) / points.size(), 0.35);
  for (const ScoreRaster* raster : {&reference.fine(), &reference.coarse(), &reference.wide()}) {
    EXPECT_GT(raster->score(points.x_m(), points.y_m(), {}) / points.size(), 0.3);
  }
}

}  // namespace
}  // namespace odoless
