// Each predicate says yes to what the dissertation states and no to its contrary, so that a report can disagree.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "core/base/rng.hpp"
#include "tools/experiment/cloud_claims.hpp"
#include "tools/experiment/fitness_claims.hpp"
#include "tools/experiment/matching_claims.hpp"
#include "tools/experiment/motion_claims.hpp"
#include "tools/experiment/path_claims.hpp"

namespace odoless {
namespace {

using Summaries = std::vector<MatchingSummary>;
using ::testing::HasSubstr;

MatchingSummary summary(std::size_t gross, double median_m, double max_m) {
  return {.label = "setting",
          .pairs = 365,
          .gross = gross,
          .median_m = median_m,
          .median_rad = 0.0005,
          .rms_m = 1.5 * median_m,
          .max_m = max_m,
          .time_median_us = 1000.0};
}

TEST(SmallPopulations, DoNotConvergeOnlyIfEachOfThemFails) {
  EXPECT_TRUE(small_populations_do_not_converge(Summaries{summary(90, 0.05, 3.0), summary(7, 0.01, 2.0)}).agrees);
  EXPECT_FALSE(small_populations_do_not_converge(Summaries{summary(90, 0.05, 3.0), summary(0, 0.01, 0.1)}).agrees);
  EXPECT_THAT(small_populations_do_not_converge(Summaries{summary(7, 0.01, 2.0)}).measured, HasSubstr("7 of 365"));
}

TEST(LargePopulations, MustHaveFewerAndLowerPeaks) {
  const Summaries small{summary(90, 0.05, 3.0), summary(7, 0.01, 2.0)};
  EXPECT_TRUE(
      large_populations_have_fewer_and_lower_peaks(small, Summaries{summary(2, 0.01, 1.0), summary(0, 0.005, 0.1)})
          .agrees);
  EXPECT_FALSE(
      large_populations_have_fewer_and_lower_peaks(small, Summaries{summary(2, 0.01, 1.0), summary(7, 0.005, 0.1)})
          .agrees)
      << "not fewer";
  EXPECT_FALSE(
      large_populations_have_fewer_and_lower_peaks(small, Summaries{summary(2, 0.01, 1.0), summary(0, 0.005, 2.5)})
          .agrees)
      << "not lower";
}

TEST(AHundredMembers, ConvergeOnlyWithoutAGrossFailure) {
  EXPECT_TRUE(population_converges(summary(0, 0.01, 0.1)).agrees);
  EXPECT_FALSE(population_converges(summary(1, 0.01, 0.3)).agrees);
}

TEST(OurAimOfExactness, HasThreeBounds) {
  EXPECT_TRUE(displacement_is_exact(summary(0, 0.0099, 0.19)).agrees);
  EXPECT_FALSE(displacement_is_exact(summary(0, 0.0101, 0.19)).agrees);
  EXPECT_FALSE(displacement_is_exact(summary(0, 0.0099, 0.21)).agrees);
  MatchingSummary turned = summary(0, 0.005, 0.1);
  turned.median_rad = 0.0018;
  EXPECT_FALSE(displacement_is_exact(turned).agrees);
}

TEST(Generations, RefineOnlyIfTheErrorFalls) {
  const Summaries falling{summary(0, 0.04, 0.3), summary(0, 0.02, 0.2), summary(0, 0.01, 0.1), summary(0, 0.009, 0.1)};
  const Summaries level(4, summary(0, 0.02, 0.2));
  const Summaries rising{summary(0, 0.01, 0.1), summary(0, 0.02, 0.1)};
  EXPECT_TRUE(generations_refine(falling).agrees);
  EXPECT_FALSE(generations_refine(level).agrees);
  EXPECT_FALSE(generations_refine(rising).agrees);
}

TEST(FewGenerations, MustConvergeAndLeaveSomethingToRefine) {
  const Summaries many{summary(0, 0.01, 0.1), summary(0, 0.009, 0.1)};
  EXPECT_TRUE(few_generations_converge_unrefined(Summaries{summary(3, 0.05, 0.3), summary(0, 0.02, 0.1)}, many).agrees);
  EXPECT_FALSE(
      few_generations_converge_unrefined(Summaries{summary(80, 0.05, 2.0), summary(0, 0.02, 0.1)}, many).agrees);
  EXPECT_FALSE(
      few_generations_converge_unrefined(Summaries{summary(0, 0.011, 0.1), summary(0, 0.01, 0.1)}, many).agrees);
}

TEST(Noise, WorsensTheErrorAndIsSurvived) {
  const Summaries rising{summary(0, 0.01, 0.1), summary(0, 0.02, 0.1), summary(3, 0.05, 0.3)};
  EXPECT_TRUE(error_grows_with_noise(rising).agrees);
  EXPECT_FALSE(error_grows_with_noise(Summaries{summary(0, 0.02, 0.1), summary(0, 0.01, 0.1)}).agrees);
  EXPECT_TRUE(noise_is_survived(rising).agrees);
  EXPECT_FALSE(noise_is_survived(Summaries{summary(8, 0.05, 0.3)}).agrees);
}

TEST(WhatIsBuiltIn, MustBeBetterAtEveryNoiseAndNoSlower) {
  const Summaries seed{summary(0, 0.01, 0.1), summary(0, 0.02, 0.2)};
  Summaries ours{summary(0, 0.005, 0.1), summary(0, 0.01, 0.2)};
  EXPECT_TRUE(default_beats_seed(seed, ours).agrees);
  ours[1].time_median_us = 1001.0;
  EXPECT_FALSE(default_beats_seed(seed, ours).agrees) << "slower";
  ours[1] = summary(0, 0.021, 0.2);
  EXPECT_FALSE(default_beats_seed(seed, ours).agrees) << "worse at one noise";
  EXPECT_FALSE(default_beats_seed({}, {}).agrees);
  EXPECT_TRUE(default_beats_seed_at_worst(seed, Summaries{summary(0, 0.009, 0.1), summary(0, 0.019, 0.2)}).agrees);
  EXPECT_FALSE(default_beats_seed_at_worst(seed, Summaries{summary(0, 0.009, 0.1), summary(0, 0.021, 0.2)}).agrees);
}

TEST(AccumulatedError, GrowsOrNot) {
  const std::vector<double> growing{0.0, 0.01, 0.02, 0.05, 0.1, 0.2, 0.3, 0.4, 0.5};
  const std::vector<double> shrinking(growing.rbegin(), growing.rend());
  EXPECT_TRUE(error_accumulates(growing).agrees);
  EXPECT_FALSE(error_accumulates(shrinking).agrees);
  EXPECT_FALSE(error_does_not_grow(growing).agrees);
  EXPECT_TRUE(error_does_not_grow(shrinking).agrees);
  EXPECT_TRUE(error_does_not_grow(std::vector<double>(9, 0.02)).agrees);
}

TEST(ErrorUnder300Mm, MustHoldOfNineInTen) {
  std::vector<double> errors_m(100, 0.1);
  std::fill(errors_m.begin(), errors_m.begin() + 10, 0.4);
  EXPECT_TRUE(error_is_mostly_small(errors_m).agrees);
  errors_m[50] = 0.31;
  EXPECT_FALSE(error_is_mostly_small(errors_m).agrees);
  EXPECT_FALSE(error_is_mostly_small({}).agrees);
}

TEST(OurAimOf100Mm, BoundsTheLargestError) {
  EXPECT_TRUE(error_is_tiny(std::vector<double>{0.02, 0.1}).agrees);
  EXPECT_FALSE(error_is_tiny(std::vector<double>{0.02, 0.101}).agrees);
  EXPECT_FALSE(error_is_tiny({}).agrees);
}

TEST(Filter, MustBeatMatchesAlone) {
  EXPECT_TRUE(filter_beats_matches(std::vector<double>{0.1}, std::vector<double>{0.3}).agrees);
  EXPECT_FALSE(filter_beats_matches(std::vector<double>{0.3}, std::vector<double>{0.3}).agrees);
}

TEST(Fitness, StaysBelowItsThresholdOrNot) {
  using Values = std::vector<double>;
  EXPECT_EQ(count_peaks(Values{3.0, 30.0, 29.9, 80.0}), 2U);
  EXPECT_TRUE(fitness_stays_below("5.10", Values{3.0, 29.9}).agrees);
  EXPECT_FALSE(fitness_stays_below("5.10", Values{3.0, 30.0}).agrees);
  EXPECT_FALSE(fitness_stays_below("5.10", {}).agrees);
  EXPECT_TRUE(peaks_are_few("5.12", "few", Values{3.0, 31.0}, 0.5).agrees);
  EXPECT_FALSE(peaks_are_few("5.12", "few", Values{3.0, 31.0}, 0.4).agrees);
  EXPECT_TRUE(sparse_scans_match_poorly(Values{40.0, 3.0, 3.0}).agrees);
  EXPECT_FALSE(sparse_scans_match_poorly(Values{3.0, 3.0, 3.0}).agrees);
}

TEST(SparseScans, NeedWideCellsInASecondTry) {
  EXPECT_TRUE(wide_cells_ease_convergence(summary(50, 0.1, 3.0), summary(30, 0.1, 3.0)).agrees);
  EXPECT_FALSE(wide_cells_ease_convergence(summary(30, 0.1, 3.0), summary(30, 0.1, 3.0)).agrees);
  const MatchingSummary none = summary(15, 0.1, 3.0);
  EXPECT_TRUE(second_try_needs_wide_cells(none, summary(11, 0.1, 3.0), summary(8, 0.1, 3.0)).agrees);
  EXPECT_FALSE(second_try_needs_wide_cells(none, summary(8, 0.1, 3.0), summary(8, 0.1, 3.0)).agrees) << "not the cells";
  EXPECT_FALSE(second_try_needs_wide_cells(none, summary(18, 0.1, 3.0), summary(16, 0.1, 3.0)).agrees) << "no use";
}

std::vector<DisplacementError> drawn_errors(double floor_m, double ratio, double turn_floor_rad) {
  Rng rng(5);
  std::vector<DisplacementError> errors;
  for (int i = 0; i < 4000; ++i) {
    DisplacementError error{.index = i};
    error.true_motion = {rng.uniform(0.0, 1.0), 0.0, rng.uniform(-0.3, 0.3)};
    error.x_m = floor_m * rng.normal();
    error.y_m = (floor_m + ratio * error.true_motion.x_m) * rng.normal();
    error.yaw_rad = turn_floor_rad * rng.normal();
    errors.push_back(error);
  }
  return errors;
}

TEST(SpreadLaw, FindsTheConstantsThatErrorsWereDrawnWith) {
  std::vector<double> displacements;
  std::vector<double> drawn;
  for (const DisplacementError& error : drawn_errors(0.004, 0.02, 0.001)) {
    displacements.push_back(error.true_motion.x_m);
    drawn.push_back(error.y_m);
  }
  const SpreadLaw law = fit_spread(displacements, drawn);
  EXPECT_NEAR(law.floor, 0.004, 0.001);
  EXPECT_NEAR(law.ratio, 0.02, 0.002);
}

TEST(SpreadsOfTheSeed, CoverErrorsThatAreSmallEnough) {
  EXPECT_TRUE(spreads_cover_errors(drawn_errors(0.004, 0.02, 0.001)).agrees);
  EXPECT_FALSE(spreads_cover_errors(drawn_errors(0.02, 0.02, 0.001)).agrees)
      << "0.02 m is the spread, not the deviation";
  EXPECT_FALSE(spreads_cover_errors(drawn_errors(0.004, 0.02, 0.01)).agrees);
}

TEST(NormalErrors, AreToldFromHeavyTailsAndFromFlatOnes) {
  Rng rng(9);
  std::vector<double> normal;
  std::vector<double> tailed;
  std::vector<double> flat;
  for (int i = 0; i < 2000; ++i) {
    normal.push_back(rng.normal());
    tailed.push_back(i % 6 == 0 ? 10.0 * rng.normal() : rng.normal());
    flat.push_back(rng.uniform(-1.0, 1.0));
  }
  EXPECT_TRUE(errors_look_normal("5.19a", "x", normal).agrees);
  EXPECT_FALSE(errors_look_normal("5.19a", "x", tailed).agrees);
  EXPECT_FALSE(errors_look_normal("5.19a", "x", flat).agrees);
}

TEST(LongDisplacements, TurnLittleOrNot) {
  std::vector<MatchRow> straight;
  std::vector<MatchRow> curved;
  for (int i = 0; i < 40; ++i) {
    const double travel_m = 0.01 * i;
    straight.push_back({.index = i, .reference_T_scan = {travel_m, 0.0, 0.4 - travel_m}});
    curved.push_back({.index = i, .reference_T_scan = {travel_m, 0.0, travel_m}});
  }
  EXPECT_TRUE(long_displacements_turn_little(straight).agrees);
  EXPECT_FALSE(long_displacements_turn_little(curved).agrees);
}

TEST(Corridor, HidesTravelAndHoldsAcross) {
  std::vector<DisplacementError> lost(10, {.index = 1, .x_m = 0.002, .y_m = -0.09, .true_motion = {0.1, 0.0, 0.0}});
  std::vector<DisplacementError> seen(10, {.index = 1, .x_m = 0.03, .y_m = -0.01, .true_motion = {0.1, 0.0, 0.0}});
  EXPECT_TRUE(corridor_hides_travel(lost).agrees);
  EXPECT_FALSE(corridor_hides_travel(seen).agrees);
  EXPECT_TRUE(corridor_holds_across(lost).agrees);
  EXPECT_FALSE(corridor_holds_across(seen).agrees);
}

TEST(Cloud, LiesOnItsSurfacesOrNot) {
  CloudOutput output{.points = std::vector<Point3>(10), .distance_median_m = 0.019, .distance_95_m = 0.059};
  EXPECT_TRUE(projects_onto_surfaces("5.34", "s", output).agrees);
  output.distance_median_m = 0.021;
  EXPECT_FALSE(projects_onto_surfaces("5.34", "s", output).agrees);
  output.distance_median_m = 0.019;
  output.distance_95_m = 0.061;
  EXPECT_FALSE(projects_onto_surfaces("5.34", "s", output).agrees);
  EXPECT_FALSE(projects_onto_surfaces("5.34", "s", CloudOutput{}).agrees) << "no point is no map";
}

TEST(Cloud, HasAFlatFloorOrNot) {
  CloudOutput output{.floor_deviation_95_m = 0.019, .saw_floor_and_walls = true};
  EXPECT_TRUE(floor_is_flat("5.34", output).agrees);
  output.floor_deviation_95_m = 0.021;
  EXPECT_FALSE(floor_is_flat("5.34", output).agrees);
  output = {.floor_deviation_95_m = 0.0, .saw_floor_and_walls = false};
  EXPECT_FALSE(floor_is_flat("5.34", output).agrees) << "no floor was seen";
}

TEST(Cloud, HoldsMostScansOrNot) {
  EXPECT_TRUE(most_scans_are_mapped("-", "s", {.scans_in_cloud = 75, .scans_without_pose = 25}).agrees);
  EXPECT_FALSE(most_scans_are_mapped("-", "s", {.scans_in_cloud = 74, .scans_without_pose = 26}).agrees);
  EXPECT_FALSE(most_scans_are_mapped("-", "s", {}).agrees);
}

}  // namespace
}  // namespace odoless
