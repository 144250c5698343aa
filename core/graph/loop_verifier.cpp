#include "core/graph/loop_verifier.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <map>

namespace odoless {
namespace {

constexpr double kPair_chi2 = 9.0;
constexpr double kPair_sd_m = 3.0;  // beyond, agreement is chance
constexpr double kValue_min = 1.5;
constexpr int kQueries_min = 3;

double value_of(const SubmapMatch& match) {
  constexpr double kWeak = 0.25;
  const double agreement = std::clamp((match.agreement - 0.7) / 0.25, 0.0, 1.0);
  return (match.is_weak ? kWeak : 1.0) * match.coverage * agreement;
}

/// Shortest paths from the submaps that are asked for, each made once.
class Projections {
 public:
  explicit Projections(const PoseGraph& graph) : graph_(graph) {}
  [[nodiscard]] Eigen::Matrix3d covariance(int from, int to) {
    if (from == to) {
      return Eigen::Matrix3d::Zero();
    }
    const auto [at, is_new] = made_.try_emplace(from);
    if (is_new) {
      graph_.project(from, at->second);
    }
    return at->second.covariances[static_cast<std::size_t>(to)];
  }

 private:
  const PoseGraph& graph_;
  std::map<int, PoseGraph::Projection> made_;
};

/// Whether b is where a and the odometry between them have it.
bool agree(const PoseGraph& graph, Projections& projections, const LoopCandidate& a, const LoopCandidate& b) {
  const Pose2 queries = graph.between(a.query, b.query);
  const Pose2 predicted = graph.between(b.reference, a.reference) * a.match.reference_T_query * queries;
  const Eigen::Matrix3d at_a =
      carried(projections.covariance(b.reference, a.reference), a.match.reference_T_query) + a.match.covariance;
  const Eigen::Matrix3d covariance =
      carried(at_a, queries) + projections.covariance(a.query, b.query) + b.match.covariance;
  const Eigen::Vector3d error = error_between(predicted, b.match.reference_T_query);
  return std::sqrt(covariance(0, 0) + covariance(1, 1)) < kPair_sd_m &&
         error.dot(covariance.inverse() * error) < kPair_chi2;
}

}  // namespace

void LoopVerifier::add(const LoopCandidate& candidate) {
  if (pool_.size() == kPool) {
    pool_.erase(pool_.begin());
  }
  pool_.push_back(candidate);
}

void LoopVerifier::renumber(std::span<const int> now) {
  for (LoopCandidate& each : pool_) {
    each.reference = now[static_cast<std::size_t>(each.reference)];
    each.query = now[static_cast<std::size_t>(each.query)];
  }
  std::erase_if(pool_, [](const LoopCandidate& each) { return std::min(each.reference, each.query) < 0; });
}

std::vector<std::vector<bool>> LoopVerifier::compare(const PoseGraph& graph) const {
  Projections projections(graph);
  std::vector<std::vector<bool>> agrees(pool_.size(), std::vector<bool>(pool_.size(), true));
  for (std::size_t a = 0; a < pool_.size(); ++a) {
    for (std::size_t b = a + 1; b < pool_.size(); ++b) {
      agrees[a][b] = agrees[b][a] = agree(graph, projections, pool_[a], pool_[b]);
    }
  }
  return agrees;
}

void LoopVerifier::evaluate(Set& set) const {
  std::map<int, double> by_query;
  for (const std::size_t member : set.members) {
    double& value = by_query[pool_[member].query];
    value = std::max(value, value_of(pool_[member].match));
  }
  set.queries = static_cast<int>(by_query.size());
  for (const auto& [query, value] : by_query) {
    set.value += value;
  }
}

// Greedy: those first that agree with most of what the first one agrees with.
LoopVerifier::Set LoopVerifier::grow(std::size_t first, const std::vector<std::vector<bool>>& agrees) const {
  std::vector<std::pair<int, std::size_t>> order;
  for (std::size_t other = 0; other < pool_.size(); ++other) {
    if (other == first || !agrees[first][other]) {
      continue;
    }
    int common = 0;
    for (std::size_t k = 0; k < pool_.size(); ++k) {
      common += agrees[first][k] && agrees[other][k] ? 1 : 0;
    }
    order.emplace_back(-common, other);
  }
  std::sort(order.begin(), order.end());
  Set set{.members = {first}};
  for (const auto& [rank, other] : order) {
    const auto agrees_with = [&, other = other](std::size_t member) { return agrees[other][member]; };
    if (std::all_of(set.members.begin(), set.members.end(), agrees_with)) {
      set.members.push_back(other);
    }
  }
  evaluate(set);
  return set;
}

std::vector<LoopCandidate> LoopVerifier::verify(const PoseGraph& graph, int newest) {
  std::erase_if(pool_, [newest](const LoopCandidate& each) { return each.query < newest - kWindow; });
  if (pool_.size() < kQueries_min) {
    return {};
  }
  const std::vector<std::vector<bool>> agrees = compare(graph);
  Set best;
  for (std::size_t first = 0; first < pool_.size(); ++first) {
    Set set = grow(first, agrees);
    if (set.value > best.value) {
      best = std::move(set);
    }
  }
  if (best.queries < kQueries_min || best.value < kValue_min) {
    return {};
  }
  std::vector<LoopCandidate> out;
  std::sort(best.members.begin(), best.members.end());
  for (const std::size_t member : best.members) {
    out.push_back(pool_[member]);
  }
  std::for_each(best.members.rbegin(), best.members.rend(),
                [this](std::size_t member) { pool_.erase(pool_.begin() + static_cast<std::ptrdiff_t>(member)); });
  return out;
}

}  // namespace odoless
