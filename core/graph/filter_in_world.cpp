#include "core/graph/filter_in_world.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/geometry/pose2_covariance.hpp"
#include "core/slam/lslam.hpp"

namespace odoless {
namespace {

constexpr double kAgreement_m = 0.25;  // of graph and filter: a degree is five metres at the far end of a building
constexpr double kAgreement_rad = 0.02;
constexpr double kReach_m = 6.0;    // from a submap's origin
constexpr std::size_t kNewest = 4;  // submaps that the filter may have had elsewhere before it was put there

/// Whether a loop closure holds a submap from beyond the one that was being made behind this one, by one from before;
/// by the first one where that was being made.
bool is_found_since(const SubmapGraph& graph, int serial) {
  const auto made = static_cast<int>(std::ranges::count_if(
      graph.submaps(), [&](const Submap& each) { return graph.keyframes().serial(each.first_keyframe) <= serial; }));
  const int before = std::max(1, made);
  return std::ranges::any_of(graph.graph().constraints(), [=](const Constraint& each) {
    return each.is_loop && each.holds() && std::min(each.from, each.to) < before && std::max(each.from, each.to) > made;
  });
}

}  // namespace

FilterInWorld::FilterInWorld(const GraphParams& params) {
  const auto submaps = static_cast<std::size_t>(params.submaps_max);
  places_.reserve(submaps);
  projection_.covariances.reserve(submaps);
  projection_.costs.reserve(submaps);
}

void FilterInWorld::update(const SubmapGraph& graph) {
  if (revision_ != graph.revision()) {
    revision_ = graph.revision();
    take(graph);
  }
  if (places_.empty() && (graph.forgotten() > 0 || graph.has_path())) {
    begin_ = graph.map_T_odom();
  }
  odom_slip_ = graph.odom_slip();
  guess_ = graph.guess();
  graph_map_T_odom_ = graph.is_behind_unknown_motion() ? std::nullopt : std::optional(graph.map_T_odom());
}

// A submap by which the filter has the robot may be no more: those of the run from before, or where others have made it
// needless; of these, one that is at the same place in the filter's map serves as well.
void FilterInWorld::take(const SubmapGraph& graph) {
  const std::optional<Place> claimed = claim_ ? std::optional(places_[*claim_]) : std::nullopt;
  const bool is_thinned = std::exchange(thinnings_, graph.thinnings()) != graph.thinnings();
  const std::size_t first = graph.first_submap();
  places_.resize(graph.submaps().size() - first);
  if (!places_.empty()) {
    graph.graph().project_drift(0, std::max(1, static_cast<int>(first)), projection_);
  }
  claim_.reset();
  for (std::size_t i = 0; i < places_.size(); ++i) {
    const Submap& submap = graph.submaps()[first + i];
    places_[i] = {.serial = graph.keyframes().serial(submap.first_keyframe),
                  .map_T_submap = graph.graph().pose(static_cast<int>(first + i)),
                  .local_T_submap = submap.local_T_submap};
    if (projection_.costs[first + i] < PoseGraph::kUnreached) {
      places_[i].drift = projection_.covariances[first + i];
    }
    claim_ = claimed && claimed->serial == places_[i].serial ? std::optional(i) : claim_;
  }
  if (claimed && !claim_ && is_thinned) {
    claim_ = nearest(claimed->local_T_submap);
  }
  if (claim_ && is_found_since(graph, claimed_after_)) {
    claim_.reset();
  }
  if (unconfirmed_after_ && is_found_since(graph, *unconfirmed_after_)) {
    unconfirmed_after_.reset();
  }
}

Pose2 FilterInWorld::follow(const Pose2& local_T_odom, const Pose2& odom_T_scan, int placements, int unconfirmed) {
  const bool is_placed = std::exchange(placements_, placements).value_or(placements) != placements;
  if (std::exchange(unconfirmed_, unconfirmed) != unconfirmed) {
    unconfirmed_after_ = unconfirmed > 0 ? std::optional(places_.empty() ? -1 : places_.back().serial) : std::nullopt;
  }
  drift_.setZero();
  if (guess_ || places_.empty()) {
    const Pose2 map_T_odom = guess_.value_or(begin_.value_or(local_T_odom));
    drift_.topLeftCorner<2, 2>() = turned(odom_slip_, map_T_odom.yaw_rad);
    return map_T_odom;
  }
  if (is_placed) {  // in the unknown: by the last known
    claim_ = nearest(local_T_odom * odom_T_scan).value_or(claim_.value_or(places_.size() - 1));
    claimed_after_ = places_.back().serial;
  }
  const Pose2 newest = graph_map_T_odom_.value_or(places_.back().map_T_local() * local_T_odom);
  if (!claim_) {
    return placed(places_.back(), newest, odom_T_scan);
  }
  const Pose2 claimed = places_[*claim_].map_T_local() * local_T_odom;
  if (graph_map_T_odom_ && are_within(claimed * odom_T_scan, newest * odom_T_scan, kAgreement_m, kAgreement_rad)) {
    claim_.reset();
    return placed(places_.back(), newest, odom_T_scan);
  }
  return placed(places_[*claim_], claimed, odom_T_scan);
}

Pose2 FilterInWorld::placed(const Place& place, const Pose2& map_T_odom, const Pose2& odom_T_scan) {
  const Pose2 map_T_scan = map_T_odom * odom_T_scan;
  drift_ = turned(carried(place.drift, place.map_T_submap.inverse() * map_T_scan), map_T_scan.yaw_rad);
  if (&place == &places_.back()) {
    drift_.topLeftCorner<2, 2>() += turned(odom_slip_, map_T_odom.yaw_rad);
  }
  return map_T_odom;
}

double FilterInWorld::within_ok() const {
  return (unconfirmed_after_ ? PoseEstimate::kUnconfirmed : 1.0) *
         probability_within(drift_, PoseEstimate::kOk_m, PoseEstimate::kOk_rad);
}

std::optional<std::size_t> FilterInWorld::nearest(const Pose2& local_T_scan) const {
  std::optional<std::size_t> found;
  double nearest_m = kReach_m;
  for (std::size_t i = 0; i + kNewest < places_.size(); ++i) {
    const double distance_m = places_[i].local_T_submap.distance_m(local_T_scan);
    if (distance_m < nearest_m) {
      nearest_m = distance_m;
      found = i;
    }
  }
  return found;
}

Pose2 FilterInWorld::to_local(const Pose2& map_T_scan) const {
  double nearest_m = std::numeric_limits<double>::infinity();
  Pose2 local_T_scan = map_T_scan;
  for (const Place& place : places_) {
    if (const double distance_m = place.map_T_submap.distance_m(map_T_scan); distance_m < nearest_m) {
      nearest_m = distance_m;
      local_T_scan = place.map_T_local().inverse() * map_T_scan;
    }
  }
  return local_T_scan;
}

}  // namespace odoless
