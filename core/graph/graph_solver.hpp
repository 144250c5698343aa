#pragma once

#include <Eigen/Sparse>
#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "core/graph/pose_graph.hpp"

namespace odoless {

/// Where one node is by something else than the graph, which may be wrong.
struct PosePrior {
  int node = 0;
  Pose2 map_T_node{};
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();  ///< over (x_m, y_m, yaw_rad) in the node's axes
};

/// Moves the nodes of a pose graph to where its constraints agree best: Gauss-Newton on a sparse Cholesky factor
/// [grisetti2010tutorial; method 9], loop closures and a prior weighted by dynamic covariance scaling [agarwal2013dcs;
/// method 9], new loop closures in full for the first iterations, so that a large loop can close. The first node of
/// each component stays, and so do nodes that are held, which cost nothing.
///
/// One for each solution: what it takes then comes from the same memory again, however the graph has grown.
/// Thread: owned by one thread. Not for real-time threads: it allocates.
class GraphSolver {
 public:
  struct Report {
    int iterations = 0;
    double chi2 = 0.0;  ///< sum of the weighted squared errors
  };

  /// What a solution takes for each constraint that the graph has room for, where a robot drives up and down one storey
  /// until there is no more: half of it to put the nodes into an order whose factor is small.
  static constexpr std::size_t kBytes_per_constraint = 896;

  /// @return  Of the last iteration. Sets the weights of loop closures.
  Report solve(PoseGraph& graph, int iterations_max, const std::optional<PosePrior>& prior = {});

 private:
  using Matrix = Eigen::SparseMatrix<double>;
  using Block = std::array<int, 2>;  ///< nodes: of the columns, and of the rows

  /// Gives the Hessian its pattern: blocks of nodes, and of constraints that move them.
  void lay_out(const PoseGraph& graph);
  /// Adds a constraint's part to the normal equations. @return  Its weighted squared error.
  double add(const PoseGraph& graph, Constraint& constraint, bool in_full);
  double add(const PoseGraph& graph, const PosePrior& prior);
  /// Adds to a block of the Hessian's lower triangle that is laid out.
  void add_block(int row, int column, const Eigen::Matrix3d& block);
  /// Largest step of a node, in metres.
  double move(PoseGraph& graph) const;

  std::vector<Block> blocks_;
  Eigen::VectorXd gradient_;
  Eigen::VectorXd step_;
  Matrix hessian_;
  Eigen::SimplicialLDLT<Matrix> factor_;
};

/// Squared error of a constraint as the graph stands, in deviations.
[[nodiscard]] double squared_error(const PoseGraph& graph, const Constraint& constraint);

}  // namespace odoless
