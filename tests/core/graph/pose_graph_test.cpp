// How uncertainties go along the edges of a graph, against drawn samples and by hand.
#include "core/graph/pose_graph.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/base/rng.hpp"

namespace odoless {
namespace {

constexpr int kSamples = 20000;

/// A small motion with the given deviations.
Pose2 drawn(Rng& rng, const Eigen::Vector3d& sd) {
  return {sd(0) * rng.normal(), sd(1) * rng.normal(), sd(2) * rng.normal()};
}

Eigen::Matrix3d diagonal(const Eigen::Vector3d& sd) { return Eigen::Matrix3d(sd.cwiseProduct(sd).asDiagonal()); }

/// Sample covariance of expected^-1 * drawn.
template <class Draw>
Eigen::Matrix3d sampled(const Pose2& expected, Draw&& draw) {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (int i = 0; i < kSamples; ++i) {
    const Eigen::Vector3d error = error_between(expected, draw());
    sum += error * error.transpose();
  }
  return sum / kSamples;
}

void expect_near(const Eigen::Matrix3d& expected, const Eigen::Matrix3d& actual) {
  EXPECT_LT((expected - actual).norm(), 0.05 * expected.norm()) << expected << "\n\n" << actual;
}

// 0 - 1 - 2 - 3, and a loop closure from 0 to 3: without 1 it is what would have been made without 1.
TEST(PoseGraph, ForgetsNodesWithAllOfTheirConstraints) {
  const auto constraint = [](int from, int to, bool is_loop) {
    return Constraint{.from = from,
                      .to = to,
                      .from_T_to = {1.0, 0.0, 0.0},
                      .covariance = diagonal({0.1, 0.1, 0.1}),
                      .is_loop = is_loop};
  };
  PoseGraph graph(8, 8);
  for (int node = 0; node < 4; ++node) {
    graph.add_node({static_cast<double>(node), 0.0, 0.0});
  }
  for (int node = 1; node < 4; ++node) {
    graph.add(constraint(node - 1, node, false));
  }
  graph.erase(1, 1);
  ASSERT_EQ(graph.size(), 3);
  EXPECT_EQ(graph.pose(1).x_m, 2.0);
  ASSERT_EQ(graph.constraints().size(), 1U);
  EXPECT_EQ(graph.constraints()[0].from, 1);
  EXPECT_EQ(graph.constraints()[0].to, 2);
  EXPECT_FALSE(graph.follows(1));
  EXPECT_TRUE(graph.follows(2));
  EXPECT_EQ(graph.component(2), 1) << "nothing leads to node 0 any more";
  PoseGraph::Projection projection;
  graph.project(0, projection);
  EXPECT_EQ(projection.costs[2], PoseGraph::kUnreached);
  graph.add(constraint(0, 2, true));
  EXPECT_EQ(graph.component(1), 0);
  graph.project(0, projection);
  EXPECT_LT(projection.costs[1], PoseGraph::kUnreached);
}

TEST(PoseGraph, KnowsTheDriftFromTheNearestOfSeveralNodesAndNotThatOfBreaks) {
  PoseGraph graph(8, 16);
  static_cast<void>(graph.add_node({}));
  for (int node = 1; node < 8; ++node) {
    static_cast<void>(graph.add_node({1.0 * node, 0.1 * node, 0.2 * node}));
    graph.add({.from = node - 1,
               .to = node,
               .from_T_to = graph.between(node - 1, node),
               .covariance = 1e-4 * Eigen::Matrix3d::Identity()});
  }
  PoseGraph::Projection from_any;
  graph.project_drift(2, 5, from_any);
  for (int node = 0; node < 8; ++node) {
    PoseGraph::Projection from_one;
    graph.project(std::clamp(node, 2, 4), from_one);
    const auto at = static_cast<std::size_t>(node);
    const Eigen::Matrix3d drift = 0.15 * 0.15 * from_one.covariances[at];
    EXPECT_LT((from_any.covariances[at] - drift).norm(), 1e-12 * drift.norm() + 1e-18) << node;
  }
  graph.constraints()[6].is_break = true;
  graph.project_drift(2, 5, from_any);
  EXPECT_GT(from_any.costs[6], 0.0);
  EXPECT_LT(from_any.covariances[7](2, 2), 1.01 * from_any.covariances[6](2, 2)) << "it adds nothing";
}

TEST(PoseGraph, HasASlipOfTheLocalMapInItsDriftAndInNoSearch) {
  PoseGraph graph(3, 4);
  for (int node = 0; node < 3; ++node) {
    static_cast<void>(graph.add_node({2.0 * node, 0.0, 0.0}));
  }
  const Eigen::Matrix3d covariance = 1e-4 * Eigen::Matrix3d::Identity();
  graph.add({.from = 0,
             .to = 1,
             .from_T_to = {2.0, 0.0, 0.0},
             .covariance = covariance,
             .map_slip = Eigen::Vector2d(0.16, 0.0).asDiagonal()});
  graph.add({.from = 1, .to = 2, .from_T_to = {2.0, 0.0, 0.0}, .covariance = covariance});
  PoseGraph::Projection drift;
  graph.project_drift(0, 1, drift);
  EXPECT_NEAR(drift.covariances[2](0, 0), 0.16, 1e-3) << "in full, and carried on";
  EXPECT_LT(drift.covariances[2](1, 1), 1e-3);
  PoseGraph::Projection search;
  graph.project(0, search);
  EXPECT_LT(search.covariances[2](0, 0), 1e-3);
  graph.add({.from = 0, .to = 2, .from_T_to = {4.0, 0.0, 0.0}, .covariance = covariance, .is_loop = true});
  graph.project_drift(0, 1, drift);
  EXPECT_LT(drift.covariances[2](0, 0), 1e-3) << "a loop closure holds it again";
  EXPECT_LT(drift.covariances[1](0, 0), 1e-3);
  graph.constraints()[0].is_break = true;
  graph.constraints()[2].weight = 0.0;
  graph.project_drift(0, 1, drift);
  EXPECT_LT(drift.covariances[2](0, 0), 1e-3) << "over a break others know";
}

TEST(PoseGraph, CarriesTheErrorOfAMotionOverTheNext) {
  const Pose2 a_T_b{1.0, 2.0, 0.5};
  const Pose2 b_T_c{-3.0, 1.0, 2.0};
  const Eigen::Vector3d sd(0.02, 0.01, 0.01);
  Rng rng(1);
  expect_near(sampled(a_T_b * b_T_c, [&] { return a_T_b * drawn(rng, sd) * b_T_c; }), carried(diagonal(sd), b_T_c));
}

TEST(PoseGraph, InvertsTheErrorOfAMotion) {
  const Pose2 a_T_b{1.0, 2.0, 0.5};
  const Eigen::Vector3d sd(0.02, 0.01, 0.01);
  Rng rng(1);
  expect_near(sampled(a_T_b.inverse(), [&] { return (a_T_b * drawn(rng, sd)).inverse(); }),
              inverted(diagonal(sd), a_T_b));
}

/// Nodes in a row, 1 m apart, each step with a deviation of 0.1 m and 0.01 rad.
PoseGraph row(int nodes) {
  PoseGraph graph(nodes, 2 * nodes);
  for (int i = 0; i < nodes; ++i) {
    static_cast<void>(graph.add_node({1.0 * i, 0.0, 0.0}));
    if (i > 0) {
      graph.add({.from = i - 1, .to = i, .from_T_to = {1.0, 0.0, 0.0}, .covariance = diagonal({0.1, 0.1, 0.01})});
    }
  }
  return graph;
}

TEST(PoseGraph, ProjectsAsDrawnAlongAChain) {
  const PoseGraph graph = row(6);
  PoseGraph::Projection projection;
  graph.project(0, projection);
  Rng rng(1);
  const Eigen::Matrix3d expected = sampled({5.0, 0.0, 0.0}, [&] {
    Pose2 pose;
    for (int i = 0; i < 5; ++i) {
      pose = pose * Pose2{1.0, 0.0, 0.0} * drawn(rng, {0.1, 0.1, 0.01});
    }
    return pose;
  });
  expect_near(expected, projection.covariances[5]);
  EXPECT_EQ(projection.costs[0], 0.0);
}

TEST(PoseGraph, ProjectsAlongTheShorterWayBothWays) {
  PoseGraph graph = row(11);
  graph.add({.from = 0,
             .to = 10,
             .from_T_to = {10.0, 0.0, 0.0},
             .covariance = diagonal({0.05, 0.05, 0.005}),
             .is_loop = true});
  PoseGraph::Projection projection;
  graph.project(0, projection);
  EXPECT_NEAR(projection.covariances[10](0, 0), 0.0025, 1e-12);
  EXPECT_NEAR(projection.covariances[9](0, 0), 0.0125, 1e-6);
  graph.project(10, projection);
  EXPECT_NEAR(projection.covariances[0](0, 0), 0.0025, 1e-12);
  graph.constraints().back().weight = 0.1;  // what the solver does not believe leads nowhere
  graph.project(0, projection);
  EXPECT_NEAR(projection.covariances[10](0, 0), 0.1, 1e-12);
}

TEST(PoseGraph, SaysWhatCannotBeReached) {
  PoseGraph graph = row(3);
  PoseGraph apart(4, 4);
  for (const Pose2& pose : graph.poses()) {
    static_cast<void>(apart.add_node(pose));
  }
  apart.add(graph.constraints()[0]);
  PoseGraph::Projection projection;
  apart.project(0, projection);
  EXPECT_LT(projection.costs[1], PoseGraph::kUnreached);
  EXPECT_EQ(projection.costs[2], PoseGraph::kUnreached);
}

TEST(PoseGraph, SaysWhenItIsFull) {
  PoseGraph graph(2, 1);
  EXPECT_TRUE(graph.has_room(1));
  static_cast<void>(graph.add_node({}));
  EXPECT_FALSE(graph.full());
  static_cast<void>(graph.add_node({}));
  graph.add({.from = 0, .to = 1, .covariance = Eigen::Matrix3d::Identity()});
  EXPECT_TRUE(graph.full());
  EXPECT_FALSE(graph.has_room(1));
}

}  // namespace
}  // namespace odoless
