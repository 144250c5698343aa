#include "firmware/world/world_mirror.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace odoless {
namespace {

bool is_same(const Pose2& a, const Pose2& b) { return a.x_m == b.x_m && a.y_m == b.y_m && a.yaw_rad == b.yaw_rad; }

bool is_finite(const Pose2& pose) {
  return std::isfinite(pose.x_m) && std::isfinite(pose.y_m) && std::isfinite(pose.yaw_rad);
}

}  // namespace

WorldMirror::WorldMirror(const SubmapWorld& world)
    : keyframes_(world.store.size()), poses_(world.graph.poses().begin(), world.graph.poses().end()) {
  for (const Constraint& each : world.graph.constraints()) {
    weights_.push_back(each.weight);
  }
}

bool WorldMirror::collect(const SubmapGraph& graph, WorldChanges& changes) const {
  const SubmapWorld world = graph.map();
  const KeyframeStore& store = world.store;
  changes.first_keyframe = keyframes_;
  int next = keyframes_ + static_cast<int>(changes.keyframes.size());
  const int most = next + kKeyframes_max;
  for (; next < std::min(graph.mapped_keyframes(), most); ++next) {
    const std::span<const BeamCode> codes = store.codes(next);
    changes.keyframes.push_back({store[next], {codes.begin(), codes.end()}});
  }
  const std::span<const Submap> submaps = world.submaps;
  changes.first_submap = static_cast<int>(poses_.size());
  int count = 0;
  for (; count < static_cast<int>(submaps.size()); ++count) {
    const Submap& submap = submaps[static_cast<std::size_t>(count)];
    const Pose2& pose = world.graph.pose(count);
    if (submap.first_keyframe + submap.keyframes > next || !is_finite(pose)) {
      break;
    }
    const bool is_new = count >= changes.first_submap;
    if (is_new) {
      changes.submaps.push_back(submap);
    }
    if (is_new || !is_same(pose, poses_[static_cast<std::size_t>(count)])) {
      changes.moved.push_back({count, pose});
    }
  }
  collect_constraints(world.graph, count, changes);
  return next < graph.mapped_keyframes();
}

void WorldMirror::collect_constraints(const PoseGraph& graph, int submaps, WorldChanges& changes) const {
  const std::span<const Constraint> constraints = graph.constraints();
  changes.first_constraint = static_cast<int>(weights_.size());
  for (std::size_t i = 0; i < constraints.size(); ++i) {
    const Constraint& each = constraints[i];
    if (i < weights_.size()) {
      if (each.weight != weights_[i]) {
        changes.weighted.push_back({static_cast<int>(i), each.weight});
      }
    } else if (std::max(each.from, each.to) < submaps) {
      changes.constraints.push_back(each);
    } else {
      return;  // what comes after it has a higher number
    }
  }
}

void WorldMirror::take(const WorldChanges& changes) {
  keyframes_ += static_cast<int>(changes.keyframes.size());
  poses_.resize(poses_.size() + changes.submaps.size());
  for (const WorldChanges::Moved& each : changes.moved) {
    poses_[static_cast<std::size_t>(each.submap)] = each.map_T_submap;
  }
  for (const Constraint& each : changes.constraints) {
    weights_.push_back(each.weight);
  }
  for (const WorldChanges::Weighted& each : changes.weighted) {
    weights_[static_cast<std::size_t>(each.constraint)] = each.weight;
  }
}

}  // namespace odoless
