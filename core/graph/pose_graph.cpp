#include "core/graph/pose_graph.hpp"

#include <algorithm>
#include <functional>
#include <numeric>
#include <utility>

#include "core/base/check.hpp"
#include "core/geometry/pose2_covariance.hpp"

namespace odoless {
namespace {

// A turn moves what lies a few metres off.
double cost_of(const Eigen::Matrix3d& covariance) {
  constexpr double kLever_m2 = 25.0;
  return covariance(0, 0) + covariance(1, 1) + kLever_m2 * covariance(2, 2);
}

}  // namespace

Eigen::Matrix3d carried(const Eigen::Matrix3d& covariance_ab, const Pose2& b_T_c) {
  const Eigen::Matrix3d move = adjoint(b_T_c.inverse());
  return move * covariance_ab * move.transpose();
}

Eigen::Matrix3d inverted(const Eigen::Matrix3d& covariance_ab, const Pose2& a_T_b) {
  return carried(covariance_ab, a_T_b.inverse());
}

Eigen::Vector3d error_between(const Pose2& measured, const Pose2& expected) {
  const Pose2 error = measured.inverse() * expected;
  return {error.x_m, error.y_m, error.yaw_rad};
}

PoseGraph::PoseGraph(int nodes_max, int constraints_max)
    : nodes_max_(static_cast<std::size_t>(nodes_max)), constraints_max_(static_cast<std::size_t>(constraints_max)) {
  poses_.reserve(static_cast<std::size_t>(nodes_max));
  components_.reserve(static_cast<std::size_t>(nodes_max));
  first_.reserve(static_cast<std::size_t>(nodes_max));
  constraints_.reserve(static_cast<std::size_t>(constraints_max));
  links_.reserve(static_cast<std::size_t>(constraints_max));
}

int PoseGraph::add_node(const Pose2& map_T_node) {
  ODOLESS_CHECK(!full());
  poses_.push_back(map_T_node);
  components_.push_back(size() - 1);
  first_.push_back(kNone);
  return size() - 1;
}

int PoseGraph::largest_component() const {
  std::vector<int> nodes(poses_.size() + 1);
  for (const int component : components_) {
    ++nodes[static_cast<std::size_t>(component)];
  }
  return static_cast<int>(std::max_element(nodes.begin(), nodes.end()) - nodes.begin());
}

// Drives in simulated buildings err by 0.03 to 0.3 of the deviations that a search must allow for, in 95 of 100 scans:
// twice this. A slip of the local map is as large as it says, or larger.
Eigen::Matrix3d Constraint::drift() const {
  constexpr double kDrift_share = 0.15;
  Eigen::Matrix3d drift = Eigen::Matrix3d::Zero();
  if (!is_break) {
    drift = kDrift_share * kDrift_share * covariance;
    drift.topLeftCorner<2, 2>() += map_slip;
  }
  return drift;
}

void PoseGraph::add(const Constraint& constraint) {
  ODOLESS_CHECK(has_room(1) && constraint.from != constraint.to);
  const int index = static_cast<int>(constraints_.size());
  int& from = first_[static_cast<std::size_t>(constraint.from)];
  int& to = first_[static_cast<std::size_t>(constraint.to)];
  constraints_.push_back(constraint);
  links_.push_back({from, to});
  from = to = index;
  const auto [first, other] = std::minmax({component(constraint.from), component(constraint.to)});
  if (first != other) {
    std::replace(components_.begin() + other, components_.end(), other, first);  // none of it comes before its first
  }
}

bool PoseGraph::follows(int node) const {
  for (int each = first_[static_cast<std::size_t>(node)]; each != kNone;) {
    const Constraint& constraint = constraints_[static_cast<std::size_t>(each)];
    if (!constraint.is_loop && constraint.to == node && constraint.from == node - 1) {
      return true;
    }
    const Links& links = links_[static_cast<std::size_t>(each)];
    each = constraint.from == node ? links.after_from : links.after_to;
  }
  return false;
}

void PoseGraph::move(int component, const Pose2& new_T_map) {
  for (std::size_t node = 0; node < poses_.size(); ++node) {
    poses_[node] = components_[node] == component ? new_T_map * poses_[node] : poses_[node];
  }
}

void PoseGraph::erase(int first, int count) {
  const std::vector<Constraint> before = std::exchange(constraints_, {});
  constraints_.reserve(constraints_max_);
  links_.clear();
  poses_.erase(poses_.begin() + first, poses_.begin() + first + count);
  components_.resize(poses_.size());
  std::iota(components_.begin(), components_.end(), 0);
  first_.assign(poses_.size(), kNone);
  const auto is_erased = [&](int node) { return first <= node && node < first + count; };
  for (Constraint each : before) {
    if (!is_erased(each.from) && !is_erased(each.to)) {
      each.from -= each.from < first ? 0 : count;
      each.to -= each.to < first ? 0 : count;
      add(each);
    }
  }
}

void PoseGraph::project(int root, Projection& out) const { project(root, root + 1, false, out); }

void PoseGraph::project_drift(int begin, int end, Projection& out) const { project(begin, end, true, out); }

void PoseGraph::project(int begin, int end, bool of_drift, Projection& out) const {
  using Entry = std::pair<double, int>;
  out.covariances.assign(poses_.size(), Eigen::Matrix3d::Zero());
  out.costs.assign(poses_.size(), kUnreached);
  std::vector<bool> is_done(poses_.size(), false);
  std::vector<Entry> open;  // a heap, as equal costs in a row are
  for (int root = begin; root < end; ++root) {
    open.emplace_back(0.0, root);
    out.costs[static_cast<std::size_t>(root)] = 0.0;
  }
  while (!open.empty()) {
    std::pop_heap(open.begin(), open.end(), std::greater<>{});
    const auto at = static_cast<std::size_t>(open.back().second);
    open.pop_back();
    if (is_done[at]) {
      continue;
    }
    is_done[at] = true;
    for (int each = first_[at]; each != kNone;) {
      const Constraint& constraint = constraints_[static_cast<std::size_t>(each)];
      const Links& links = links_[static_cast<std::size_t>(each)];
      const bool is_forward = static_cast<std::size_t>(constraint.from) == at;
      each = is_forward ? links.after_from : links.after_to;
      const auto next = static_cast<std::size_t>(is_forward ? constraint.to : constraint.from);
      if (is_done[next] || !constraint.holds()) {
        continue;
      }
      const Pose2 step = poses_[at].inverse() * poses_[next];
      const Eigen::Matrix3d own = of_drift ? constraint.drift() : constraint.covariance;
      const Eigen::Matrix3d covariance =
          carried(out.covariances[at], step) + (is_forward ? own : inverted(own, constraint.from_T_to));
      const double cost = cost_of(covariance);
      if (cost < out.costs[next]) {
        out.costs[next] = cost;
        out.covariances[next] = covariance;
        open.emplace_back(cost, static_cast<int>(next));
        std::push_heap(open.begin(), open.end(), std::greater<>{});
      }
    }
  }
}

}  // namespace odoless
