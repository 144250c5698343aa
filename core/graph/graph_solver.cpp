#include "core/graph/graph_solver.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "core/geometry/pose2_covariance.hpp"

namespace odoless {
namespace {

constexpr double kScaling = 12.0;      // squared error up to which a loop closure counts in full
constexpr int kIterations_new = 6;     // in which new ones do in any case
constexpr int kIterations_settle = 2;  // that they are then weighted for at least
constexpr double kConverged_m = 1e-3;
constexpr double kLever_m = 20.0;  // of a turn that counts as a step
constexpr double kFixed = 1e9;

/// Of the first unknown of a node; each has three.
Eigen::Index row_of(int node) { return Eigen::Index{3} * node; }

/// Whether a constraint moves anything: it holds, and not all that it joins is held.
bool is_used(const PoseGraph& graph, const Constraint& constraint) {
  return constraint.weight > 0.0 && std::max(constraint.from, constraint.to) >= graph.held();
}

double scaled_weight(double squared_error) {
  const double scale = std::min(1.0, 2.0 * kScaling / (kScaling + squared_error));
  return scale * scale;
}

/// A constraint's error in its own axes, and how it changes with small changes of both poses over (x_m, y_m, yaw_rad)
/// in the map's axes.
struct Linearised {
  Eigen::Vector3d error;
  Eigen::Matrix3d by_from = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d by_to = Eigen::Matrix3d::Zero();
};

Linearised linearise(const Pose2& map_T_from, const Pose2& map_T_to, const Pose2& from_T_to) {
  const Eigen::Matrix2d measured_T_from = turn_matrix(-from_T_to.yaw_rad).topLeftCorner<2, 2>();
  const Eigen::Matrix2d turn = measured_T_from * turn_matrix(-map_T_from.yaw_rad).topLeftCorner<2, 2>();
  const Eigen::Vector2d way(map_T_to.x_m - map_T_from.x_m, map_T_to.y_m - map_T_from.y_m);
  Linearised out;
  out.error = error_between(from_T_to, map_T_from.inverse() * map_T_to);
  out.by_from.topLeftCorner<2, 2>() = -turn;
  out.by_from.topRightCorner<2, 1>() = turn * Eigen::Vector2d(way.y(), -way.x());
  out.by_from(2, 2) = -1.0;
  out.by_to.topLeftCorner<2, 2>() = turn;
  out.by_to(2, 2) = 1.0;
  return out;
}

}  // namespace

double squared_error(const PoseGraph& graph, const Constraint& constraint) {
  const Eigen::Vector3d error = error_between(constraint.from_T_to, graph.between(constraint.from, constraint.to));
  return error.dot(constraint.covariance.inverse() * error);
}

double GraphSolver::add(const PoseGraph& graph, Constraint& constraint, bool in_full) {
  const Linearised at = linearise(graph.pose(constraint.from), graph.pose(constraint.to), constraint.from_T_to);
  const Eigen::Matrix3d information = constraint.covariance.inverse();
  const double squares = at.error.dot(information * at.error);
  if (constraint.is_loop) {
    constraint.weight = in_full && constraint.is_new ? 1.0 : scaled_weight(squares);
  }
  const Eigen::Matrix3d weighted = constraint.weight * information;
  add_block(constraint.from, constraint.from, at.by_from.transpose() * weighted * at.by_from);
  add_block(constraint.to, constraint.to, at.by_to.transpose() * weighted * at.by_to);
  const Eigen::Matrix3d across = at.by_to.transpose() * weighted * at.by_from;
  if (constraint.to > constraint.from) {
    add_block(constraint.to, constraint.from, across);
  } else {
    add_block(constraint.from, constraint.to, across.transpose());
  }
  gradient_.segment<3>(row_of(constraint.from)) -= at.by_from.transpose() * weighted * at.error;
  gradient_.segment<3>(row_of(constraint.to)) -= at.by_to.transpose() * weighted * at.error;
  return constraint.weight * squares;
}

double GraphSolver::add(const PoseGraph& graph, const PosePrior& prior) {
  const Linearised at = linearise({}, graph.pose(prior.node), prior.map_T_node);
  const Eigen::Matrix3d information = prior.covariance.inverse();
  const double squares = at.error.dot(information * at.error);
  const Eigen::Matrix3d weighted = scaled_weight(squares) * information;
  add_block(prior.node, prior.node, at.by_to.transpose() * weighted * at.by_to);
  gradient_.segment<3>(row_of(prior.node)) -= at.by_to.transpose() * weighted * at.error;
  return scaled_weight(squares) * squares;
}

void GraphSolver::add_block(int row, int column, const Eigen::Matrix3d& block) {
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) {
      if (3 * row + i >= 3 * column + k) {
        hessian_.coeffRef(3 * row + i, 3 * column + k) += block(i, k);
      }
    }
  }
}

void GraphSolver::lay_out(const PoseGraph& graph) {
  blocks_.clear();
  for (int node = 0; node < graph.size(); ++node) {
    blocks_.push_back({node, node});
  }
  for (const Constraint& constraint : graph.constraints()) {
    if (is_used(graph, constraint)) {
      const auto [column, row] = std::minmax(constraint.from, constraint.to);
      blocks_.push_back({column, row});
    }
  }
  std::sort(blocks_.begin(), blocks_.end());
  blocks_.erase(std::unique(blocks_.begin(), blocks_.end()), blocks_.end());
  hessian_.resize(row_of(graph.size()), row_of(graph.size()));
  hessian_.reserve(static_cast<Eigen::Index>(9 * blocks_.size()));
  for (auto column = blocks_.begin(); column != blocks_.end();) {
    const auto end = std::find_if(column, blocks_.end(), [&](const Block& block) { return block[0] != (*column)[0]; });
    for (int k = 0; k < 3; ++k) {
      const Eigen::Index at = row_of((*column)[0]) + k;
      hessian_.startVec(at);
      for (auto block = column; block != end; ++block) {
        for (Eigen::Index row = row_of((*block)[1]); row < row_of((*block)[1]) + 3; ++row) {
          if (row >= at) {
            hessian_.insertBack(row, at) = 0.0;
          }
        }
      }
    }
    column = end;
  }
  hessian_.finalize();
}

double GraphSolver::move(PoseGraph& graph) const {
  double largest_m = 0.0;
  for (int node = graph.held(); node < graph.size(); ++node) {
    const Eigen::Vector3d step = step_.segment<3>(row_of(node));
    Pose2& pose = graph.poses()[static_cast<std::size_t>(node)];
    pose = {pose.x_m + step.x(), pose.y_m + step.y(), wrap_angle(pose.yaw_rad + step.z())};
    largest_m = std::max({largest_m, std::abs(step.x()), std::abs(step.y()), kLever_m * std::abs(step.z())});
  }
  return largest_m;
}

GraphSolver::Report GraphSolver::solve(PoseGraph& graph, int iterations_max, const std::optional<PosePrior>& prior) {
  Report report;
  if (graph.size() < 2) {
    return report;
  }
  const bool has_new =
      std::any_of(graph.constraints().begin(), graph.constraints().end(), [](const Constraint& c) { return c.is_new; });
  const int at_least = has_new ? kIterations_new + kIterations_settle : 0;
  lay_out(graph);
  factor_.analyzePattern(hessian_);
  bool has_converged = false;
  while (report.iterations < iterations_max && !has_converged) {
    hessian_.coeffs().setZero();
    gradient_.setZero(row_of(graph.size()));
    report.chi2 = 0.0;
    for (Constraint& constraint : graph.constraints()) {
      if (is_used(graph, constraint)) {
        report.chi2 += add(graph, constraint, report.iterations < kIterations_new);
      }
    }
    if (prior) {
      report.chi2 += add(graph, *prior);
    }
    for (int node = 0; node < graph.size(); ++node) {
      if (graph.component(node) == node || node < graph.held()) {
        add_block(node, node, kFixed * Eigen::Matrix3d::Identity());
      }
    }
    factor_.factorize(hessian_);
    step_ = factor_.solve(gradient_);
    const double moved_m = move(graph);
    ++report.iterations;
    has_converged = moved_m < kConverged_m && report.iterations > at_least;
  }
  for (Constraint& constraint : graph.constraints()) {
    if (constraint.is_loop && is_used(graph, constraint)) {
      constraint.weight = scaled_weight(squared_error(graph, constraint));
    }
  }
  return report;
}

}  // namespace odoless
