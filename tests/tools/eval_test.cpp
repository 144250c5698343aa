#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/rng.hpp"
#include "tests/support/data.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tools/command/error.hpp"
#include "tools/eval/report.hpp"

namespace odoless {
namespace {

constexpr double kTiny = 1e-9;

Pose2 random_pose(Rng& rng, double reach_m) {
  return {rng.uniform(-reach_m, reach_m), rng.uniform(-reach_m, reach_m), rng.uniform(-3.1, 3.1)};
}

std::vector<ReferencePose> random_walk(Rng& rng, int poses) {
  std::vector<ReferencePose> walk;
  Pose2 pose;
  for (int i = 0; i < poses; ++i) {
    walk.push_back({0.2 * i, pose});
    pose = pose * Pose2{rng.uniform(0.0, 0.5), rng.uniform(-0.1, 0.1), rng.uniform(-0.5, 0.5)};
  }
  return walk;
}

std::vector<ReferencePose> moved(const Pose2& motion, std::vector<ReferencePose> poses) {
  for (ReferencePose& pose : poses) {
    pose.pose = motion * pose.pose;
  }
  return poses;
}

std::vector<Relation> relations_of(Rng& rng, const std::vector<ReferencePose>& poses, int count) {
  std::vector<Relation> relations;
  for (int i = 0; i < count; ++i) {
    const auto& from = poses[rng.below(static_cast<std::uint32_t>(poses.size()))];
    const auto& to = poses[rng.below(static_cast<std::uint32_t>(poses.size()))];
    relations.push_back({from.stamp_s, to.stamp_s, from.pose.inverse() * to.pose});
  }
  return relations;
}

TEST(Statistics, OfAHandfulOfNumbers) {
  const Statistics s = summarise(std::vector<double>{4.0, 1.0, 3.0, 2.0});
  EXPECT_EQ(s.count, 4U);
  EXPECT_DOUBLE_EQ(s.mean, 2.5);
  EXPECT_DOUBLE_EQ(s.median, 2.5);
  EXPECT_DOUBLE_EQ(s.deviation, std::sqrt(1.25));
  EXPECT_DOUBLE_EQ(s.root_mean_square, std::sqrt(7.5));
  EXPECT_DOUBLE_EQ(s.max, 4.0);
  EXPECT_DOUBLE_EQ(s.percentile_99, 4.0);
  EXPECT_DOUBLE_EQ(summarise(std::vector<double>{5.0, 1.0, 2.0}).median, 2.0);
  EXPECT_EQ(summarise(std::vector<double>{}).count, 0U);
}

TEST(Statistics, PercentileLeavesOneInAHundredAbove) {
  std::vector<double> values;
  for (int i = 1; i <= 200; ++i) {
    values.push_back(i);
  }
  EXPECT_DOUBLE_EQ(summarise(values).percentile_99, 198.0);
}

TEST(StampLookup, FindsTheNearestAsASearchThroughAllDoes) {
  Rng rng(5);
  std::vector<ReferencePose> poses;
  for (int i = 0; i < 50; ++i) {
    poses.push_back({rng.uniform(0.0, 10.0), {static_cast<double>(i), 0, 0}});
  }
  const StampLookup lookup(poses);
  for (int i = 0; i < 500; ++i) {
    const double stamp_s = rng.uniform(-1.0, 11.0);
    const auto nearest = std::min_element(poses.begin(), poses.end(), [&](const auto& a, const auto& b) {
      return std::abs(a.stamp_s - stamp_s) < std::abs(b.stamp_s - stamp_s);
    });
    const auto found = lookup.nearest(stamp_s, 0.1);
    ASSERT_EQ(found.has_value(), std::abs(nearest->stamp_s - stamp_s) <= 0.1);
    if (found) {
      ASSERT_EQ(found->x_m, nearest->pose.x_m);
    }
  }
  EXPECT_FALSE(StampLookup({}).nearest(0.0, 1e9).has_value());
}

TEST(Relations, MeasureAKnownError) {
  const std::vector<ReferencePose> estimate{{0.0, {5, 5, 0.5 * std::numbers::pi}},
                                            {1.0, {5, 7, 0.5 * std::numbers::pi}}};
  const std::vector<Relation> relations{{0.0, 1.0, {1.7, 0.4, 0.1}}, {0.0, 2.0, {}}, {3.0, 1.0, {}}};
  const RelationsResult result = evaluate_relations(relations, estimate, {});
  EXPECT_EQ(result.used, 1U);
  EXPECT_EQ(result.missing, 2U);
  EXPECT_NEAR(result.errors.translation_m.mean, 0.5, kTiny) << "(2, 0) instead of (1.7, 0.4)";
  EXPECT_NEAR(result.errors.rotation_rad.mean, 0.1, kTiny);
}

TEST(Relations, DoNotSeeAMotionOfTheWholeEstimate) {
  Rng rng(1);
  for (int round = 0; round < 20; ++round) {
    const auto walk = random_walk(rng, 60);
    const auto relations = relations_of(rng, walk, 40);
    const auto exact = evaluate_relations(relations, moved(random_pose(rng, 100), walk), {});
    EXPECT_EQ(exact.used, 40U);
    EXPECT_LT(exact.errors.translation_m.max, 1e-9);
    EXPECT_LT(exact.errors.rotation_rad.max, 1e-9);
  }
}

TEST(Relations, TakeTheLasersPlaceIntoAccount) {
  Rng rng(2);
  const auto robot = random_walk(rng, 60);
  const auto relations = relations_of(rng, robot, 40);
  auto laser = robot;
  for (auto& pose : laser) {
    pose.pose = pose.pose * Pose2{0.3, 0.0, 0.0};
  }
  EXPECT_LT(evaluate_relations(relations, laser, {.laser_x_m = 0.3}).errors.translation_m.max, 1e-9);
  EXPECT_GT(evaluate_relations(relations, laser, {}).errors.translation_m.max, 0.1);
}

TEST(Relations, AreCountedAsOffByTheTimeBetweenTheirPoses) {
  const std::vector<ReferencePose> still{{0, {}}, {15, {}}, {16, {}}};
  const auto result = evaluate_relations(std::vector<Relation>{{0, 15, {0.29, 0, 0.08}},
                                                               {15, 0, {0.31, 0, 0}},
                                                               {15, 16, {0, 0, -0.09}},
                                                               {0, 16, {0, 0.49, 3}},
                                                               {16, 0, {0.51, 0, 0}}},
                                         still, {});
  EXPECT_EQ(result.one_visit.used, 3U);
  EXPECT_EQ(result.one_visit.off, 2U);
  EXPECT_EQ(result.across_loops.used, 2U);
  EXPECT_EQ(result.across_loops.off, 1U);
}

TEST(Relations, AreReadFromText) {
  const test::TemporaryFolder folder;
  const auto relations = read_relations(folder.file("r", "# t1 t2\n1 2 3 4 99 0.1 0.2 -0.5\n\n"));
  ASSERT_EQ(relations.size(), 1U);
  EXPECT_EQ(relations[0].from_s, 1.0);
  EXPECT_EQ(relations[0].to_s, 2.0);
  EXPECT_EQ(relations[0].from_T_to.y_m, 4.0);
  EXPECT_EQ(relations[0].from_T_to.yaw_rad, -0.5);
  EXPECT_THROW(static_cast<void>(read_relations(folder.file("a", "1 2 3\n"))), DataError);
  EXPECT_THROW(static_cast<void>(read_relations(folder.file("b", ""))), DataError);
}

TEST(Relations, GiveThePublishedFigureOfARealRun) {
  ODOLESS_DATA_FILE(relations, "fr079.relations.xz");
  ODOLESS_DATA_FILE(trajectory, "fr079-gmapping.traj.xz");
  const auto result = evaluate_relations(read_relations(relations), read_reference_poses(trajectory).poses, {});
  EXPECT_EQ(result.used + result.missing, 1685U);
  EXPECT_NEAR(result.errors.translation_m.mean, 0.058, 5e-4);
  EXPECT_NEAR(to_deg(result.errors.rotation_rad.mean), 0.70, 5e-3);
}

TEST(Ate, AlignmentFindsTheMotionBetweenTwoCopies) {
  Rng rng(3);
  for (int round = 0; round < 50; ++round) {
    const Pose2 motion = random_pose(rng, 50);
    std::vector<PosePair> pairs;
    for (const ReferencePose& pose : random_walk(rng, 10)) {
      pairs.push_back({motion * pose.pose, pose.pose});
    }
    const PoseError error = pose_error(motion, align(pairs));
    EXPECT_LT(error.translation_m, 1e-9);
    EXPECT_LT(error.rotation_rad, 1e-9);
  }
}

TEST(Ate, NoOtherAlignmentIsBetter) {
  Rng rng(4);
  std::vector<PosePair> pairs;
  for (int i = 0; i < 20; ++i) {
    pairs.push_back({random_pose(rng, 5), random_pose(rng, 5)});
  }
  const auto cost = [&](const Pose2& motion) {
    double sum = 0.0;
    for (const PosePair& pair : pairs) {
      sum += std::pow((motion * pair.estimate).distance_m(pair.reference), 2);
    }
    return sum;
  };
  const Pose2 best = align(pairs);
  for (int i = 0; i < 300; ++i) {
    const Pose2 step{rng.uniform(-0.1, 0.1), rng.uniform(-0.1, 0.1), rng.uniform(-0.1, 0.1)};
    EXPECT_GE(cost({best.x_m + step.x_m, best.y_m + step.y_m, best.yaw_rad + step.yaw_rad}), cost(best) - 1e-9);
  }
}

TEST(Ate, IsTheSameWhereverBothTrajectoriesLie) {
  Rng rng(6);
  const auto reference = random_walk(rng, 80);
  auto estimate = random_walk(rng, 80);
  const AteResult plain = evaluate_ate(reference, estimate, {});
  const AteResult other = evaluate_ate(moved(random_pose(rng, 9), reference), moved(random_pose(rng, 9), estimate), {});
  EXPECT_GT(plain.errors.translation_m.mean, 0.1);
  EXPECT_NEAR(plain.errors.translation_m.root_mean_square, other.errors.translation_m.root_mean_square, 1e-9);
  EXPECT_NEAR(plain.errors.rotation_rad.mean, other.errors.rotation_rad.mean, 1e-9);
}

TEST(Ate, MeasuresAKnownError) {
  // A square with one corner pushed out by 0.4 m along the diagonal, twice: alignment cannot hide all of it.
  const std::vector<ReferencePose> reference{{0, {1, 1, 0}}, {1, {-1, 1, 0}}, {2, {-1, -1, 0}}, {3, {1, -1, 0}}};
  auto estimate = moved({7, 8, 2.0}, {{0.004, {1.1, 1.1, 0}}, {1, {-1, 1, 0}}, {2, {-1.1, -1.1, 0}}, {3, {1, -1, 0}}});
  estimate.push_back({9.0, {}});
  const AteResult result = evaluate_ate(reference, estimate, {});
  EXPECT_EQ(result.used, 4U);
  EXPECT_EQ(result.missing, 1U);
  EXPECT_NEAR(result.errors.translation_m.max, 0.1 * std::sqrt(2.0), kTiny);
  EXPECT_NEAR(result.errors.translation_m.root_mean_square, 0.1, kTiny);
  EXPECT_NEAR(result.errors.rotation_rad.max, 0.0, kTiny);
}

TEST(Ate, NeedsTwoPosesInCommon) {
  const std::vector<ReferencePose> one{{0, {1, 1, 0}}};
  EXPECT_EQ(evaluate_ate(one, one, {}).used, 0U);
}

MatchRow row(int reference_index, int index, const Pose2& motion) {
  return {.reference_index = reference_index,
          .index = index,
          .reference_stamp_s = 0.2 * reference_index,
          .stamp_s = 0.2 * index,
          .reference_T_scan = motion,
          .time_us = 100.0 * index,
          .converged = index != 2};
}

TEST(Pairs, MeasureKnownErrorsAndCountGrossFailures) {
  const ReferencePoses reference{.poses = {{0.0, {1, 1, 0.5}},
                                           {0.2, Pose2{1, 1, 0.5} * Pose2{1, 0, 0}},
                                           {0.4, Pose2{1, 1, 0.5} * Pose2{2, 0, 0}}}};
  const std::vector<MatchRow> rows{row(0, 1, {1.03, 0.04, 0}), row(1, 2, {1.3, 0, 0}), row(2, 3, {}),
                                   row(0, 2, {2, 0, to_rad(6.0)})};
  const PairsResult result = evaluate_pairs(reference, rows, {});
  EXPECT_EQ(result.used, 3U);
  EXPECT_EQ(result.missing, 1U);
  EXPECT_EQ(result.gross, 2U);
  EXPECT_NEAR(result.errors.translation_m.median, 0.05, kTiny);
  EXPECT_NEAR(result.errors_of_good.translation_m.root_mean_square, 0.05, kTiny);
  EXPECT_NEAR(to_deg(result.errors.rotation_rad.max), 6.0, 1e-6);
  EXPECT_NEAR(result.converged_share, 0.5, kTiny);
  EXPECT_NEAR(result.time_us.max, 300.0, kTiny);
  ASSERT_EQ(result.worst.size(), 3U);
  EXPECT_EQ(result.worst[0].row.index, 2);
  EXPECT_NEAR(result.worst[0].error.translation_m, 0.3, kTiny) << "1.5 times its limit, the turn 1.2 times";
}

TEST(Pairs, GoByIndexWhereALogHasNoStamps) {
  const ReferencePoses reference{
      .is_log = true, .has_stamps = false, .poses = {{0, {}}, {0, {1, 0, 0}}, {0, {1, 1, 0}}}};
  const std::vector<MatchRow> rows{row(0, 1, {1, 0, 0}), row(1, 2, {0, 1, 0}), row(2, 3, {})};
  const PairsResult result = evaluate_pairs(reference, rows, {});
  EXPECT_EQ(result.used, 2U);
  EXPECT_EQ(result.missing, 1U);
  EXPECT_LT(result.errors.translation_m.max, kTiny);
}

TEST(Pairs, DoNotSeeAMotionOfTheReference) {
  Rng rng(8);
  const auto walk = random_walk(rng, 30);
  std::vector<MatchRow> rows;
  for (int i = 1; i < 30; ++i) {
    const auto& before = walk[static_cast<std::size_t>(i - 1)];
    rows.push_back(
        row(i - 1, i, before.pose.inverse() * walk[static_cast<std::size_t>(i)].pose * Pose2{0.01, 0, 0.02}));
  }
  const PairsResult result = evaluate_pairs({.poses = moved(random_pose(rng, 90), walk)}, rows, {});
  EXPECT_EQ(result.used, 29U);
  EXPECT_NEAR(result.errors.translation_m.root_mean_square, 0.01, kTiny);
  EXPECT_NEAR(result.errors.rotation_rad.mean, 0.02, kTiny);
  EXPECT_EQ(result.gross, 0U);
}

TEST(Report, TellsTheSameInBothForms) {
  const ReferencePoses reference{.poses = {{0.0, {}}, {0.2, {1, 0, 0}}}};
  const Report both = report(evaluate_pairs(reference, std::vector{row(0, 1, {1.5, 0, to_rad(1.0)})}, {}));
  EXPECT_EQ(both.json["gross_failures"], 1);
  EXPECT_DOUBLE_EQ(both.json["gross_percent"], 100.0);
  EXPECT_NEAR(both.json["translation_m"]["rmse"].get<double>(), 0.5, kTiny);
  EXPECT_NEAR(both.json["rotation_deg"]["median"].get<double>(), 1.0, kTiny);
  EXPECT_EQ(both.json["worst"][0]["index"], 1);
  EXPECT_THAT(both.text, ::testing::HasSubstr("rmse 0.5000"));
}

}  // namespace
}  // namespace odoless
