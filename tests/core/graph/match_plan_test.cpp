// Which older submaps one is matched with, by hand.
#include "core/graph/match_plan.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <limits>
#include <numeric>
#include <vector>

namespace odoless {
namespace {

constexpr double kAny_m = std::numeric_limits<double>::infinity();
constexpr int kMany = 100;

/// A chain there and back, 3 m from submap to submap, whose odometry may be off by so much at each.
struct Chain {
  explicit Chain(int there, double sd_m = 0.1, double sd_rad = 0.01) : graph(64, 64), plan(64) {
    for (int i = 0; i < 2 * there; ++i) {
      const double x_m = i < there ? 3.0 * i : 3.0 * (2 * there - 1 - i);
      graph.add_node({x_m, i < there ? 0.0 : 0.5, 0.0});
      if (i > 0) {
        graph.add({.from = i - 1,
                   .to = i,
                   .from_T_to = graph.between(i - 1, i),
                   .covariance = Eigen::Vector3d(sd_m * sd_m, sd_m * sd_m, sd_rad * sd_rad).asDiagonal()});
      }
    }
    plan.add_submaps(static_cast<std::size_t>(graph.size()));
  }
  /// References of the newest submap, in their order.
  std::vector<int> planned(int most = kMany, double sd_max_m = kAny_m, int first_own = 0) {
    plan.clear();
    plan.append(graph, graph.size() - 1, first_own, most, sd_max_m);
    std::vector<int> out;
    while (const auto next = plan.next(graph)) {
      EXPECT_EQ(next->query, graph.size() - 1);
      out.push_back(next->reference);
    }
    return out;
  }

  PoseGraph graph;
  MatchPlan plan;
};

TEST(MatchPlan, TakesTheNearestFirstAndNoneThatCannotOverlap) {
  Chain chain(10);
  const std::vector<int> planned = chain.planned();
  ASSERT_FALSE(planned.empty());
  EXPECT_EQ(planned.front(), 0) << "where the chain comes back to";
  double before_m = 0.0;
  for (const int reference : planned) {
    const double distance_m = chain.graph.between(reference, 19).distance_m({});
    EXPECT_GE(distance_m, before_m - 0.5);
    EXPECT_LT(distance_m, 6.0 + 3.0 * 0.1 * 20.0) << reference;
    before_m = distance_m;
  }
}

TEST(MatchPlan, ItsOwnPastIsNoLoop) {
  Chain chain(10);
  const std::vector<int> own = chain.planned();
  ASSERT_FALSE(own.empty());
  EXPECT_LE(*std::ranges::max_element(own), 19 - 4);
  Chain turned(10, 0.1, 0.4);  // unless the robot may have turned round
  const std::vector<int> planned = turned.planned();
  EXPECT_NE(std::ranges::find(planned, 18), planned.end());
  Chain resumed(10);  // or they are another run's
  const std::vector<int> others = resumed.planned(kMany, kAny_m, 19);
  EXPECT_NE(std::ranges::find(others, 18), others.end());
}

TEST(MatchPlan, TakesAsManyAsOneAsksForAndThoseThatAreSureEnough) {
  Chain chain(10);
  const std::vector<int> all = chain.planned();
  ASSERT_GT(all.size(), 2U);
  Chain same(10);
  EXPECT_EQ(same.planned(2), std::vector<int>(all.begin(), all.begin() + 2));
  Chain sure(10);
  const std::vector<int> near = sure.planned(kMany, 0.25);
  EXPECT_LT(near.size(), all.size());
  EXPECT_EQ(std::ranges::find(near, 0), near.end()) << "nineteen steps away";
}

TEST(MatchPlan, TriesAMatchAgainOnceTheSubmapLiesElsewhere) {
  Chain chain(10);
  ASSERT_FALSE(chain.planned().empty());
  EXPECT_TRUE(chain.planned().empty());
  chain.graph.poses()[19].y_m += 0.9;
  EXPECT_TRUE(chain.planned().empty());
  chain.graph.poses()[19].y_m += 0.2;
  EXPECT_FALSE(chain.planned().empty());
}

TEST(MatchPlan, TriesAMatchAgainOnceItIsKnownWhereTheSubmapLies) {
  Chain chain(10);
  ASSERT_FALSE(chain.planned().empty());
  chain.graph.add({.from = 0,
                   .to = 19,
                   .from_T_to = chain.graph.between(0, 19),
                   .covariance = Eigen::Vector3d(1e-4, 1e-4, 1e-4).asDiagonal(),
                   .is_loop = true});
  const std::vector<int> again = chain.planned();
  EXPECT_NE(std::ranges::find(again, 0), again.end());
  EXPECT_TRUE(chain.planned().empty());
}

TEST(MatchPlan, RemembersItsMatchesWhereSubmapsHaveOtherNumbers) {
  Chain chain(10);
  const std::vector<int> before = chain.planned();
  ASSERT_NE(std::ranges::find(before, 2), before.end());
  std::vector<int> now(20);
  std::iota(now.begin(), now.end(), -1);  // the first one is no more: now[0] is -1
  chain.graph.erase(0, 1);
  chain.plan.renumber(now);
  ASSERT_EQ(chain.graph.size(), 19);
  EXPECT_TRUE(chain.planned().empty()) << "all that are left were tried";
}

}  // namespace
}  // namespace odoless
