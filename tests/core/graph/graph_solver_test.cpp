// The sparse solver against a plain dense one with numeric derivatives, and what users rely on: loops close, and a loop
// closure that contradicts the others does not bend the graph.
#include "core/graph/graph_solver.hpp"

#include <gtest/gtest.h>
#include <malloc.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <vector>

#include "core/base/rng.hpp"
#include "tests/support/allocation_guard.hpp"

namespace odoless {
namespace {

Eigen::Matrix3d diagonal(double sd_m, double sd_rad) {
  return Eigen::Vector3d(sd_m * sd_m, sd_m * sd_m, sd_rad * sd_rad).asDiagonal();
}

/// A ring of `nodes` poses whose true ones are known; each step measured with noise.
struct Ring {
  PoseGraph graph;
  std::vector<Pose2> truth;

  Ring(int nodes, double sd_m, double sd_rad, std::uint64_t seed) : graph(nodes, 3 * nodes) {
    Rng rng(seed);
    Pose2 map_T_node;
    for (int i = 0; i < nodes; ++i) {
      const double angle_rad = 2.0 * std::numbers::pi * i / nodes;
      truth.push_back(Pose2{10.0, 0.0, 0.5 * std::numbers::pi}.inverse() * Pose2{10.0 * std::cos(angle_rad),
                                                                                 10.0 * std::sin(angle_rad),
                                                                                 angle_rad + 0.5 * std::numbers::pi});
      if (i > 0) {
        const Pose2 step = truth[static_cast<std::size_t>(i - 1)].inverse() * truth[static_cast<std::size_t>(i)] *
                           Pose2{sd_m * rng.normal(), sd_m * rng.normal(), sd_rad * rng.normal()};
        map_T_node = map_T_node * step;
        static_cast<void>(graph.add_node(map_T_node));
        graph.add({.from = i - 1, .to = i, .from_T_to = step, .covariance = diagonal(sd_m, sd_rad)});
      } else {
        static_cast<void>(graph.add_node(map_T_node));
      }
    }
  }

  void close(int from, int to, const Pose2& off = {}) {
    graph.add({.from = from,
               .to = to,
               .from_T_to = truth[static_cast<std::size_t>(from)].inverse() * truth[static_cast<std::size_t>(to)] * off,
               .covariance = diagonal(0.02, 0.005),
               .is_loop = true,
               .is_new = true});
  }

  [[nodiscard]] double worst_error_m() const {
    double worst_m = 0.0;
    for (int i = 0; i < graph.size(); ++i) {
      worst_m = std::max(worst_m, graph.pose(i).distance_m(truth[static_cast<std::size_t>(i)]));
    }
    return worst_m;
  }
};

/// Gauss-Newton with central differences and a dense matrix; every constraint counts in full. Node 0 stays.
void solve_plainly(PoseGraph& graph, const std::optional<PosePrior>& prior) {
  constexpr double kStep = 1e-6;
  const int size = 3 * graph.size();
  const auto rows = 3 * static_cast<int>(graph.constraints().size() + (prior ? 1 : 0));
  const auto errors = [&] {
    Eigen::VectorXd out(rows);
    int row = 0;
    for (const Constraint& each : graph.constraints()) {
      const Eigen::Matrix3d root = each.covariance.inverse().llt().matrixU();
      out.segment<3>(row) = root * error_between(each.from_T_to, graph.between(each.from, each.to));
      row += 3;
    }
    if (prior) {
      const Eigen::Matrix3d root = prior->covariance.inverse().llt().matrixU();
      out.segment<3>(row) = root * error_between(prior->map_T_node, graph.pose(prior->node));
    }
    return out;
  };
  const auto shift = [&](int k, double by) {
    Pose2& pose = graph.poses()[static_cast<std::size_t>(k / 3)];
    (k % 3 == 0 ? pose.x_m : k % 3 == 1 ? pose.y_m : pose.yaw_rad) += by;
  };
  for (int iteration = 0; iteration < 30; ++iteration) {
    Eigen::MatrixXd jacobian(rows, size - 3);
    for (int k = 3; k < size; ++k) {
      shift(k, kStep);
      const Eigen::VectorXd above = errors();
      shift(k, -2.0 * kStep);
      jacobian.col(k - 3) = (above - errors()) / (2.0 * kStep);
      shift(k, kStep);
    }
    const Eigen::VectorXd step = (jacobian.transpose() * jacobian).ldlt().solve(-(jacobian.transpose() * errors()));
    for (int k = 3; k < size; ++k) {
      shift(k, step(k - 3));
    }
  }
}

void expect_as_plain(const std::optional<PosePrior>& prior) {
  Ring ring(24, 0.05, 0.02, 1);
  ring.close(0, 23);
  ring.close(2, 20);
  Ring plain = ring;
  GraphSolver solver;
  static_cast<void>(solver.solve(ring.graph, 50, prior));
  for (const Constraint& each : ring.graph.constraints()) {
    ASSERT_EQ(each.weight, 1.0);  // else the plain one solves another problem
  }
  solve_plainly(plain.graph, prior);
  for (int i = 0; i < ring.graph.size(); ++i) {
    EXPECT_LT(ring.graph.pose(i).distance_m(plain.graph.pose(i)), 2e-3) << "node " << i;
    EXPECT_NEAR(wrap_angle(ring.graph.pose(i).yaw_rad - plain.graph.pose(i).yaw_rad), 0.0, 2e-4) << "node " << i;
  }
}

TEST(GraphSolver, GivesThePosesOfAPlainSolver) {
  expect_as_plain({});
  const Pose2 map_T_node = Ring(24, 0.05, 0.02, 1).truth[12] * Pose2{0.1, -0.1, 0.03};
  expect_as_plain(PosePrior{.node = 12, .map_T_node = map_T_node, .covariance = diagonal(0.1, 0.05)});
}

TEST(GraphSolver, ClosesALoopThatIsOpenByMetres) {
  Ring ring(60, 0.03, 0.06, 3);
  const double open_m = ring.worst_error_m();
  ASSERT_GT(open_m, 2.0);
  ring.close(0, 59);
  ring.close(1, 58);
  ring.close(2, 57);
  GraphSolver solver;
  const GraphSolver::Report report = solver.solve(ring.graph, 50);
  EXPECT_LT(report.iterations, 50);
  EXPECT_LT(ring.graph.between(0, 59).distance_m(ring.truth.front().inverse() * ring.truth.back()), 0.1);
  EXPECT_LT(ring.worst_error_m(), 0.75 * open_m);
}

TEST(GraphSolver, GivesAContradictingClosureNoWeight) {
  Ring ring(60, 0.01, 0.002, 1);
  for (int i = 0; i < 5; ++i) {
    ring.close(i, 59 - i);
  }
  Ring wrong = ring;
  wrong.close(10, 50, {4.0, -3.0, 0.5});
  GraphSolver solver;
  static_cast<void>(solver.solve(ring.graph, 50));
  static_cast<void>(solver.solve(wrong.graph, 50));
  EXPECT_LT(wrong.graph.constraints().back().weight, 0.05);
  EXPECT_LT(wrong.worst_error_m(), ring.worst_error_m() + 0.1);
}

TEST(GraphSolver, IsTheSameAgain) {
  Ring first(40, 0.02, 0.01, 7);
  first.close(0, 39);
  Ring second = first;
  GraphSolver solver;
  GraphSolver fresh;
  static_cast<void>(solver.solve(first.graph, 20));
  static_cast<void>(fresh.solve(second.graph, 20));
  for (int i = 0; i < first.graph.size(); ++i) {
    EXPECT_EQ(first.graph.pose(i).x_m, second.graph.pose(i).x_m);
    EXPECT_EQ(first.graph.pose(i).yaw_rad, second.graph.pose(i).yaw_rad);
  }
}

// As a daemon's heap is, which gives nothing back: what was there once is enough for all solutions while the graph
// grows.
TEST(GraphSolver, TakesTheMemoryThatItSaysWhereARobotGoesUpAndDownAStoreyUntilThereIsNoRoom) {
  if (!AllocationGuard::kWorks) {
    GTEST_SKIP() << "the sanitizer owns the heap functions";
  }
  constexpr int kPlaces = 34;
  constexpr int kClosures = 24;  // of a submap
  constexpr int kLeft = 4096;    // a quarter: from then on the graph is thinned
  const auto place_of = [](int node) { return std::abs((node + kPlaces) % (2 * kPlaces) - kPlaces); };
  const Eigen::Matrix3d covariance = diagonal(0.05, 0.02);
  PoseGraph graph(2048, 16384);
  Rng rng(1);
  mallopt(M_MMAP_MAX, 0);
  mallopt(M_TRIM_THRESHOLD, std::numeric_limits<int>::max());
  static_cast<void>(std::vector<char>(GraphSolver::kBytes_per_constraint * 16384, 'x'));
  const std::size_t before_bytes = mallinfo2().arena;
  for (int node = 0; graph.has_room(kLeft + kClosures); ++node) {
    static_cast<void>(graph.add_node({5.0 * place_of(node), 0.0, 0.0}));
    if (node > 0) {
      graph.add({.from = node - 1, .to = node, .from_T_to = graph.between(node - 1, node), .covariance = covariance});
    }
    int closures = 0;
    for (int older = node - 2; older >= 0 && closures < kClosures; --older) {
      if (std::abs(place_of(older) - place_of(node)) <= 1 && rng.uniform() < 0.5) {
        graph.add({.from = older,
                   .to = node,
                   .from_T_to = graph.between(older, node),
                   .covariance = covariance,
                   .is_loop = true});
        ++closures;
      }
    }
    if (node % 20 == 0) {
      static_cast<void>(GraphSolver().solve(graph, 3));
    }
  }
  EXPECT_EQ(mallinfo2().arena, before_bytes);
}

}  // namespace
}  // namespace odoless
