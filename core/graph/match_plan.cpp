#include "core/graph/match_plan.hpp"

#include <algorithm>
#include <cmath>

#include "core/math/principal_axes.hpp"

namespace odoless {
namespace {

constexpr int kNeighbours = 4;            // submaps before one that are its own past and not a loop
constexpr double kNeighbours_rad2 = 0.1;  // unless the robot's turn is this uncertain
constexpr double kReach_m = 6.0;          // between origins of submaps that overlap
constexpr double kDeviations = 3.0;
constexpr double kAgain_m = 1.0;  // change of the predicted pose from which on a match is tried again
constexpr double kNear_sd_m = 0.35;

double largest_sd(const Eigen::Matrix3d& covariance) {
  return std::sqrt(std::max(0.0, math::principal_axes<2>(covariance.topLeftCorner<2, 2>()).values(1)));
}

}  // namespace

void MatchPlan::renumber(std::span<const int> now) {
  constexpr int kNone = -1;
  std::size_t stays = 0;
  for (std::size_t query = 0; query < attempts_.size(); ++query) {
    if (now[query] < 0) {
      continue;
    }
    Attempts& attempts = attempts_[stays++] = attempts_[query];
    for (std::size_t i = 0; i < attempts.count; ++i) {
      int& reference = attempts.each[i].reference;
      reference = reference < 0 ? kNone : now[static_cast<std::size_t>(reference)];
    }
  }
  attempts_.resize(stays);
}

void MatchPlan::clear() {
  candidates_.clear();
  next_ = 0;
}

void MatchPlan::append(const PoseGraph& graph, int query, int first_own, int most, double sd_max_m) {
  graph.project(query, projection_);
  std::vector<Candidate> found;
  for (int reference = 0; reference < query; ++reference) {
    const auto at = static_cast<std::size_t>(reference);
    const Eigen::Matrix3d& covariance = projection_.covariances[at];
    if (projection_.costs[at] >= PoseGraph::kUnreached ||
        (query - reference < kNeighbours && reference >= first_own && covariance(2, 2) < kNeighbours_rad2)) {
      continue;
    }
    const Pose2 query_T_reference = graph.between(query, reference);
    const double distance_m = query_T_reference.distance_m({});
    Candidate candidate{.reference = reference, .query = query, .sd_m = largest_sd(covariance)};
    if (candidate.sd_m > sd_max_m || distance_m > kDeviations * candidate.sd_m + kReach_m ||
        !is_worth_trying(graph, candidate)) {
      continue;
    }
    candidate.sd_rad = std::sqrt(covariance(2, 2));
    candidate.order = distance_m / (candidate.sd_m + kDeviations);
    candidate.covariance = inverted(covariance, query_T_reference);
    found.push_back(candidate);
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const Candidate& a, const Candidate& b) { return a.order < b.order; });
  found.resize(std::min(found.size(), static_cast<std::size_t>(most)));
  candidates_.insert(candidates_.end(), found.begin(), found.end());
}

std::optional<MatchPlan::Candidate> MatchPlan::next(const PoseGraph& graph) {
  if (next_ == candidates_.size()) {
    return std::nullopt;
  }
  note(graph, candidates_[next_]);
  return candidates_[next_++];
}

bool MatchPlan::is_worth_trying(const PoseGraph& graph, const Candidate& candidate) const {
  const Attempts& attempts = attempts_[static_cast<std::size_t>(candidate.query)];
  for (std::size_t i = 0; i < attempts.count; ++i) {
    const Attempt& before = attempts.each[i];
    if (before.reference == candidate.reference) {
      return before.predicted.distance_m(graph.between(candidate.reference, candidate.query)) > kAgain_m ||
             (candidate.sd_m < kNear_sd_m && before.sd_m >= kNear_sd_m);
    }
  }
  return attempts.count < kAttempts;
}

void MatchPlan::note(const PoseGraph& graph, const Candidate& candidate) {
  Attempts& attempts = attempts_[static_cast<std::size_t>(candidate.query)];
  const Attempt now{candidate.reference, graph.between(candidate.reference, candidate.query), candidate.sd_m};
  for (std::size_t i = 0; i < attempts.count; ++i) {
    if (attempts.each[i].reference == candidate.reference) {
      attempts.each[i] = now;
      return;
    }
  }
  if (attempts.count < kAttempts) {
    attempts.each[attempts.count++] = now;
  }
}

}  // namespace odoless
