// A world that is continued: the robot is found in it wherever it starts, and is not found in another building.
#include "core/graph/localiser.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <memory>
#include <vector>

#include "tests/core/graph/graph_drive.hpp"

namespace odoless {
namespace {

/// A round of the ring, which ends as a world.
struct Mapped : Drive {
  Mapped() : Drive(ring(18.0, 10.0), {0.002, 0.0, 0.0002}) {
    drive(kRound);
    drive(kRound);
    graph.finish();
  }
};

const Mapped& mapped() {
  static const Mapped run;
  return run;
}

/// A second run, which continues that world.
struct Continued : Drive {
  explicit Continued(SimulatedScene scene = ring(18.0, 10.0), const SubmapGraph& world = mapped().graph)
      : Drive(std::move(scene), {0.002, 0.0, 0.0002}) {
    EXPECT_TRUE(graph.resume(world.world()));
  }
  [[nodiscard]] Pose2 truth() const { return mapped().poses.front().inverse() * poses.back(); }
  /// Of what is known or guessed.
  [[nodiscard]] double error_m() const {
    return (graph.guess().value_or(graph.map_T_odom()) * odom.back().map_T_scan).distance_m(truth());
  }
  [[nodiscard]] bool is_found() const { return graph.is_joined() || graph.guess(); }
};

TEST(Localiser, GuessesWhereTheRobotIs) {
  const std::vector<std::vector<Point2>> drives{
      {{-10.5, 2.0}, {-10.5, -6.5}},  // against the way in which it was mapped
      {{10.5, -3.0}, {10.5, 6.5}},
      {{0.0, 6.5}, {9.0, 6.5}},
      {{3.0, -6.5}, {-10.5, -6.5}, {-10.5, -3.0}},
  };
  for (const std::vector<Point2>& corners : drives) {
    Continued run;
    EXPECT_FALSE(run.is_found());
    run.drive(corners);
    EXPECT_TRUE(run.is_found()) << corners.front().x_m << ", " << corners.front().y_m;
    EXPECT_LT(run.error_m(), 0.15);
  }
}

// A robot that was switched on and rests. Where a corner is in view one scan is enough; none of these guesses is wrong.
TEST(Localiser, GuessesWhereARobotAtRestIsByItsFirstScan) {
  int guessed = 0;
  for (const double x_m : {-10.5, -9.0, -3.0, 3.0, 9.0, 10.5}) {
    for (const double y_m : {-6.5, 6.5}) {
      for (const double ahead_m : {-0.01, 0.01}) {
        Continued run;
        run.drive({{x_m, y_m}, {x_m + ahead_m, y_m}});
        EXPECT_FALSE(run.graph.is_joined()) << "one scan makes no place sure";
        if (run.graph.guess()) {
          ++guessed;
          EXPECT_LT(run.error_m(), 0.15) << x_m << ", " << y_m << ", " << ahead_m;
        }
      }
    }
  }
  EXPECT_GE(guessed, 6);
}

// A robot at its dock that is switched on and off, and never there for long enough to be found.
TEST(Localiser, ARunThatEndedWhereItBeganIsNoOtherPlace) {
  const std::vector<Point2> at_rest{{-10.5, -6.5}, {-10.49, -6.5}};
  std::vector<std::unique_ptr<Continued>> runs;
  const SubmapGraph* world = &mapped().graph;
  for (int i = 0; i < 40; ++i) {
    runs.push_back(std::make_unique<Continued>(ring(18.0, 10.0), *world));
    runs.back()->drive(at_rest);
    ASSERT_TRUE(runs.back()->graph.guess()) << "run " << i;
    EXPECT_LT(runs.back()->error_m(), 0.15);
    runs.back()->graph.finish();
    ASSERT_FALSE(runs.back()->graph.is_joined());
    world = &runs.back()->graph;
  }
  Continued expected(ring(18.0, 10.0), *world);
  expected.graph.expect(mapped().poses.front().inverse() * Pose2{-10.5, -6.5, 0.0});
  expected.drive(at_rest);
  EXPECT_TRUE(expected.graph.is_joined());
  EXPECT_LT(expected.error_m(), 0.15);
}

TEST(Localiser, IsSureAfterAWhileAndHasAllOfThePathWhereTheRobotWas) {
  Continued run;
  run.drive({{-10.5, 2.0}, {-10.5, -6.5}, {10.5, -6.5}, {10.5, 2.0}});
  ASSERT_TRUE(run.graph.is_joined());
  EXPECT_LT(run.error_m(), 0.15);
  const auto& corrections = run.feed.corrections;
  const auto is_found = [](const Feed::Correction& each) { return each.said.cause == CorrectionCause::kFound; };
  ASSERT_EQ(std::ranges::count_if(corrections, is_found), 1);
  const auto& [found, before, after] = *std::ranges::find_if(corrections, is_found);
  EXPECT_LT(found.reference, mapped().graph.graph().size());
  EXPECT_NEAR(std::hypot(found.moved.x_m, found.moved.y_m), after.distance_m(before), 1e-9);
  run.graph.finish();
  const std::vector<StampedPose> path = run.graph.corrected(run.odom);
  for (std::size_t i = 0; i < path.size(); ++i) {
    ASSERT_LT(path[i].map_T_scan.distance_m(mapped().poses.front().inverse() * run.poses[i]), 0.25) << i;
  }
}

// On a busy machine keyframes come while a piece is searched, and the place may be found just as a submap ends.
TEST(Localiser, FindsTheRobotWhileKeyframesComeAndEachIsOfOneSubmap) {
  for (const double begin_m : {0.5, 1.0, 1.5, 2.0}) {
    Continued run;
    run.feed.steps_max = 12;
    run.drive({{-10.5, begin_m}, {-10.5, -6.5}, {10.5, -6.5}, {10.5, 2.0}});
    EXPECT_TRUE(run.graph.is_joined()) << begin_m;
    EXPECT_LT(run.error_m(), 0.15) << begin_m;
    run.graph.finish();
    int next = run.graph.first_keyframe();
    for (const Submap& submap : run.graph.submaps().subspan(run.graph.first_submap())) {
      EXPECT_EQ(submap.first_keyframe, next) << begin_m;
      next = submap.end_keyframe();
    }
    EXPECT_EQ(next, run.graph.keyframes().size()) << begin_m;
  }
}

// What is driven while a piece is searched counts.
TEST(Localiser, LosesNoWayWhileItSearches) {
  const auto way_until_found_m = [](int steps_max) {
    Continued run;
    run.feed.steps_max = steps_max;
    constexpr double kStep_m = 0.25;
    double way_m = 0.0;
    for (; !run.graph.is_joined() && way_m < 8.5; way_m += kStep_m) {
      run.drive({{-10.5, 2.0 - way_m}, {-10.5, 2.0 - way_m - kStep_m}});
    }
    for (; !run.graph.is_joined() && way_m < 25.0; way_m += kStep_m) {
      run.drive({{way_m - 19.0, -6.5}, {way_m - 19.0 + kStep_m, -6.5}});
    }
    return way_m;
  };
  const double at_once_m = way_until_found_m(std::numeric_limits<int>::max());
  const double busy_m = way_until_found_m(15);
  std::printf("  found after %.2f m, on a busy machine after %.2f m\n", at_once_m, busy_m);
  EXPECT_LT(busy_m, at_once_m + 2.0);
}

TEST(Localiser, LeavesTheOldWorldAsItWas) {
  Continued run;
  run.drive({{-10.5, 2.0}, {-10.5, -6.5}, {10.5, -6.5}, {10.5, 2.0}});
  ASSERT_TRUE(run.graph.is_joined());
  run.graph.finish();
  for (int i = 0; i < mapped().graph.graph().size(); ++i) {
    EXPECT_LT(run.graph.graph().pose(i).distance_m(mapped().graph.graph().pose(i)), 0.1) << i;
  }
}

TEST(Localiser, BelievesAnExpectedPoseOnceAScanConfirmsIt) {
  const Pose2 start = mapped().poses.front().inverse() * Pose2{-10.5, -5.0, 0.0};
  Continued right;
  right.graph.expect(start * Pose2{0.4, -0.3, 0.1});
  right.drive({{-10.5, -5.0}, {-10.49, -5.0}});
  EXPECT_TRUE(right.graph.is_joined());
  EXPECT_LT(right.error_m(), 0.1);
  Continued wrong;
  wrong.graph.expect(mapped().poses.front().inverse() * Pose2{10.5, -3.0, 0.0});
  wrong.drive({{-10.5, -5.0}, {-10.49, -5.0}});
  EXPECT_FALSE(wrong.is_found());
  wrong.drive({{-10.49, -5.0}, {-10.5, 6.5}, {-5.0, 6.5}});
  EXPECT_TRUE(wrong.is_found());
  EXPECT_LT(wrong.error_m(), 0.15);
}

TEST(Localiser, FindsNothingInAnotherBuilding) {
  Continued run(ring(14.0, 16.0, 6));
  run.drive({{-8.5, -9.5}, {8.5, -9.5}, {8.5, 9.5}, {-8.5, 9.5}, {-8.5, -9.5}});
  EXPECT_FALSE(run.graph.is_joined());
  Continued corridor(hotel());
  corridor.drive({{1.0, 0.0}, {40.0, 0.0}});
  EXPECT_FALSE(corridor.graph.is_joined());
}

TEST(Localiser, TheMapIsThisRunsOwnOnceThatIsTheLargerPart) {
  Drive small(ring(14.0, 16.0, 6), {0.002, 0.0, 0.0002});
  small.drive({{-8.5, -9.5}, {-5.5, -9.5}});
  small.graph.finish();
  Drive run(ring(18.0, 10.0), {0.002, 0.0, 0.0002});
  ASSERT_TRUE(run.graph.resume(small.graph.world()));
  EXPECT_FALSE(run.graph.is_in_world());
  run.drive({{-10.5, 2.0}, {-10.5, -6.5}, {10.5, -6.5}});
  EXPECT_FALSE(run.graph.is_joined());
  EXPECT_TRUE(run.graph.is_in_world());
  EXPECT_FALSE(run.graph.world().has(0)) << "where the rest lies is not known";
  EXPECT_TRUE(run.graph.world().has(static_cast<int>(run.graph.submaps().size()) - 1));
}

// A pose that was guessed in the world does not leave it because this run has mapped more by now.
TEST(Localiser, AGuessKeepsTheMapThatItIsOf) {
  Drive small(ring(18.0, 10.0), {0.002, 0.0, 0.0002});
  small.drive({{-10.5, -2.0}, {-10.5, -6.5}, {-8.0, -6.5}});
  small.graph.finish();
  Drive run(ring(18.0, 10.0), {0.002, 0.0, 0.0002});
  ASSERT_TRUE(run.graph.resume(small.graph.world()));
  bool is_guess_of_less = false;
  run.drive({{-10.5, 0.0}, {-10.5, -0.5}});
  for (Point2 at{-10.5, -0.5}; at.x_m < -7.0;) {
    const bool was_guessed = run.graph.guess().has_value();
    const Point2 next = at.y_m > -6.25 ? Point2{at.x_m, at.y_m - 0.5} : Point2{at.x_m + 0.5, at.y_m};
    run.drive({at, next});
    at = next;
    EXPECT_TRUE(!was_guessed || run.graph.is_joined() || !run.graph.is_in_world()) << at.x_m << ", " << at.y_m;
    is_guess_of_less |= run.graph.guess() && run.graph.keyframes().size() > 2 * small.graph.keyframes().size();
  }
  EXPECT_TRUE(is_guess_of_less) << "this run never had the larger part";
}

TEST(Localiser, RefusesAWorldThatIsLargerThanItsRoom) {
  GraphParams small;
  small.submaps_max = 16;
  SubmapGraph graph(small, RobotLimits{}, ScanParams{}, 1);
  ASSERT_GT(mapped().graph.submaps().size(), 16U);
  EXPECT_FALSE(graph.resume(mapped().graph.world()));
}

/// A run that only finds its way in that world.
struct Localising : Drive {
  explicit Localising(SimulatedScene scene = ring(18.0, 10.0)) : Drive(std::move(scene), {0.002, 0.0, 0.0002}) {
    EXPECT_TRUE(graph.resume(mapped().graph.world(), WorldUse::kLocalise));
  }
  [[nodiscard]] double error_m() const {
    return (graph.guess().value_or(graph.map_T_odom()) * odom.back().map_T_scan)
        .distance_m(mapped().poses.front().inverse() * poses.back());
  }
};

TEST(Localising, FindsTheWayForAsLongAsOneLikesInTheSameMemoryAndTheWorldStaysAsItIs) {
  Localising run;
  run.drive({{-10.5, 2.0}, {-10.5, -6.5}});
  double worst_m = 0.0;
  for (int i = 0; i < 5; ++i) {
    for (std::size_t k = 1; k < kRound.size(); ++k) {
      run.drive({kRound[k - 1], kRound[k]});
      worst_m = run.graph.is_joined() ? std::max(worst_m, run.error_m()) : worst_m;
    }
  }
  ASSERT_TRUE(run.graph.is_joined());
  EXPECT_LT(worst_m, 0.15);
  EXPECT_GT(run.graph.forgotten(), 10);
  EXPECT_LE(run.graph.submaps().size() - run.graph.first_submap(), 42U);
  EXPECT_LT(run.graph.keyframes().size() - run.graph.first_keyframe(), 42 * GraphParams{}.submap_keyframes);
  const SubmapWorld world = run.graph.map();
  ASSERT_EQ(world.submaps.size(), mapped().graph.submaps().size());
  for (std::size_t i = 0; i < world.submaps.size(); ++i) {
    const Pose2 before = mapped().graph.graph().pose(static_cast<int>(i));
    const Pose2 after = run.graph.graph().pose(static_cast<int>(i));
    EXPECT_TRUE(before.x_m == after.x_m && before.y_m == after.y_m && before.yaw_rad == after.yaw_rad) << i;
  }
  run.graph.finish();
  const std::vector<StampedPose> path = run.graph.corrected(run.odom);
  for (std::size_t i = 0; i < path.size(); ++i) {
    ASSERT_LT(path[i].map_T_scan.distance_m(mapped().poses.front().inverse() * run.poses[i]), 0.25) << i;
  }
}

TEST(Localising, WhereItIsNeverFoundItTakesNoMoreMemory) {
  Drive small(ring(18.0, 10.0), {0.002, 0.0, 0.0002});
  small.drive({{-10.5, 2.0}, {-10.5, -6.5}});
  small.graph.finish();
  Drive run(hotel(), {0.002, 0.0, 0.0002});
  ASSERT_TRUE(run.graph.resume(small.graph.world(), WorldUse::kLocalise));
  for (int i = 0; i < 3; ++i) {
    run.drive({{1.0, 0.0}, {50.0, 0.0}});
    run.drive({{50.0, 0.0}, {1.0, 0.0}});
    EXPECT_FALSE(run.graph.is_in_world());
  }
  EXPECT_GT(run.graph.forgotten(), 10);
  EXPECT_LE(run.graph.submaps().size() - run.graph.first_submap(), 42U);
}

// What it has seen of the way since then it keeps, and the state says that it may be wrong.
TEST(Localising, IsSureUntilNothingOfTheWorldHasHeldItForFiveSubmaps) {
  Drive half(ring(18.0, 10.0), {0.002, 0.0, 0.0002});
  half.drive({{-10.5, -6.5}, {10.5, -6.5}, {10.5, 6.5}});
  half.graph.finish();
  Drive run(ring(18.0, 10.0), {0.002, 0.0, 0.0002});
  ASSERT_TRUE(run.graph.resume(half.graph.world(), WorldUse::kLocalise));
  run.drive({{-10.5, -6.5}, {10.5, -6.5}, {10.5, 6.5}});
  ASSERT_TRUE(run.graph.is_in_world());
  double way_m = 0.0;
  const auto drive_on = [&](const Point2& from, const Point2& to) {  // while it is sure
    const double length_m = std::hypot(to.x_m - from.x_m, to.y_m - from.y_m);
    for (double at = 0.0; at < 1.0 && run.graph.is_in_world(); at += 0.5 / length_m) {
      const double next = at + 0.5 / length_m;
      run.drive({{from.x_m + at * (to.x_m - from.x_m), from.y_m + at * (to.y_m - from.y_m)},
                 {from.x_m + next * (to.x_m - from.x_m), from.y_m + next * (to.y_m - from.y_m)}});
      way_m += 0.5;
    }
  };
  drive_on({10.5, 6.5}, {-10.5, 6.5});
  drive_on({-10.5, 6.5}, {-10.5, -1.0});
  drive_on({-10.5, -1.0}, {-10.5, 6.5});
  drive_on({-10.5, 6.5}, {8.0, 6.5});
  EXPECT_FALSE(run.graph.is_in_world());
  EXPECT_GT(way_m, 4 * GraphParams{}.submap_travel_m);
  EXPECT_LT(way_m, 9 * GraphParams{}.submap_travel_m);
  const Pose2 at = run.poses.back();
  run.drive({{at.x_m, at.y_m}, {-10.5, 6.5}, {10.5, 6.5}, {10.5, -6.5}, {-10.5, -6.5}});
  EXPECT_TRUE(run.graph.is_in_world());
}

TEST(Localising, APoseThatSomebodySaysIsTriedAndNotBelieved) {
  Localising run;
  run.drive({{-10.5, 2.0}, {-10.5, -6.5}, {10.5, -6.5}, {10.5, -2.0}});
  ASSERT_TRUE(run.graph.is_joined());
  run.graph.expect(mapped().poses.front().inverse() * Pose2{-10.5, -3.0, 0.0});
  EXPECT_FALSE(run.graph.is_joined());
  EXPECT_TRUE(run.graph.is_guessed());
  EXPECT_LT(run.error_m(), 0.2) << "until something speaks for it";
  run.drive({{10.5, -2.0}, {10.5, 6.5}, {-10.5, 6.5}, {-10.5, 0.0}});
  EXPECT_TRUE(run.graph.is_joined());
  EXPECT_LT(run.error_m(), 0.15);
}

TEST(Localising, ARobotThatWasCarriedIsLookedForAgain) {
  Localising run;
  run.drive({{-10.5, 2.0}, {-10.5, -6.5}, {10.5, -6.5}, {10.5, -2.0}});
  ASSERT_TRUE(run.graph.is_joined());
  run.carry({-10.5, -2.0, -1.5});
  EXPECT_FALSE(run.graph.is_joined());
  run.drive({{-10.5, -2.0}, {-10.5, -6.5}, {10.5, -6.5}, {10.5, 2.0}});
  EXPECT_TRUE(run.graph.is_joined());
  EXPECT_LT(run.error_m(), 0.15);
}

}  // namespace
}  // namespace odoless
