// Where submaps lay that are no more, by hand.
#include "core/graph/past_path.hpp"

#include <gtest/gtest.h>

#include <cstddef>
#include <vector>

namespace odoless {
namespace {

SubmapPlace place(double x_m, std::int64_t stamp_ns = 0) { return {{x_m, 0.0, 0.0}, {x_m, 1.0, 0.0}, stamp_ns}; }

const PoseGraph& no_graph() {
  static const PoseGraph graph(1, 1);
  return graph;
}

TEST(PastPath, WhatWasNotKnownLiesWhereTheRobotIsFound) {
  PastPath path;
  path.add(place(1.0), true);
  path.add(place(2.0), false);
  path.add(place(3.0), false);
  path.join({10.0, 0.0, 0.0});
  path.join({10.0, 0.0, 0.0});  // of what has come since: nothing
  const std::vector<SubmapPlace> places = path.submaps(no_graph());
  ASSERT_EQ(places.size(), 3U);
  EXPECT_EQ(places[0].map_T_submap.x_m, 1.0);
  EXPECT_EQ(places[1].map_T_submap.x_m, 12.0);
  EXPECT_EQ(places[2].map_T_submap.x_m, 13.0);
  EXPECT_EQ(places[2].odom_T_submap.x_m, 3.0);
}

TEST(PastPath, WhatWillNeverBeKnownIsLost) {
  PastPath path;
  path.add(place(1.0), false);
  path.add(place(2.0), true);
  path.add(place(3.0), false);
  path.lose();
  const std::vector<SubmapPlace> places = path.submaps(no_graph());
  ASSERT_EQ(places.size(), 2U) << "with the second, that of the first is known too";
  EXPECT_EQ(places[1].map_T_submap.x_m, 2.0);
}

TEST(PastPath, OneThatLiesByAnotherMovesWithItAndWithItsHeir) {
  PoseGraph graph(4, 4);
  graph.add_node({0.0, 0.0, 0.0});
  graph.add_node({5.0, 0.0, 0.0});
  graph.add_node({6.0, 2.0, 0.0});
  PastPath path;
  Submap gone;
  gone.odom_T_submap = {7.0, 0.0, 0.0};
  gone.origin_stamp_ns = 9;
  path.add(gone, 1, {1.0, 0.5, 0.0});
  graph.poses()[1] = {5.0, 1.0, 0.0};
  ASSERT_EQ(path.submaps(graph).size(), 1U);
  EXPECT_EQ(path.submaps(graph)[0].map_T_submap.x_m, 6.0);
  EXPECT_EQ(path.submaps(graph)[0].map_T_submap.y_m, 1.5);
  EXPECT_EQ(path.submaps(graph)[0].odom_T_submap.x_m, 7.0);
  EXPECT_EQ(path.submaps(graph)[0].origin_stamp_ns, 9);

  const std::vector<Pose2> before(graph.poses().begin(), graph.poses().end());
  SubmapNumbers numbers(3);  // the second is no more, and the third has its constraints
  numbers.now = {0, SubmapNumbers::kNone, 1};
  numbers.heir = {0, 1, 1};
  graph.erase(1, 1);
  path.renumber(numbers, before, graph);
  EXPECT_NEAR(path.submaps(graph)[0].map_T_submap.x_m, 6.0, 1e-12) << "it has not moved";
  EXPECT_NEAR(path.submaps(graph)[0].map_T_submap.y_m, 1.5, 1e-12);
  graph.poses()[1].x_m += 3.0;
  EXPECT_NEAR(path.submaps(graph)[0].map_T_submap.x_m, 9.0, 1e-12);
}

TEST(PastPath, TheOlderHalfGoesWhereThereAreTooMany) {
  PastPath path;
  for (std::size_t i = 0; i < PastPath::kSubmaps_max; ++i) {
    path.add(place(static_cast<double>(i)), i < PastPath::kSubmaps_max / 4 * 3);
  }
  path.add(place(-1.0), false);
  path.join({0.5, 0.0, 0.0});
  const std::vector<SubmapPlace> places = path.submaps(no_graph());
  constexpr std::size_t kLeft = PastPath::kSubmaps_max / 2 + 1;
  ASSERT_EQ(places.size(), kLeft);
  EXPECT_EQ(places.front().map_T_submap.x_m, static_cast<double>(PastPath::kSubmaps_max / 2));
  EXPECT_EQ(places[kLeft / 2 - 1].map_T_submap.x_m, static_cast<double>(PastPath::kSubmaps_max / 4 * 3 - 1));
  EXPECT_EQ(places[kLeft / 2].map_T_submap.x_m, static_cast<double>(PastPath::kSubmaps_max / 4 * 3) + 0.5);
  EXPECT_EQ(places.back().map_T_submap.x_m, -0.5);
}

}  // namespace
}  // namespace odoless
