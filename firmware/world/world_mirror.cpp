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

WorldMirror::WorldMirror(const SubmapWorld& world) : poses_(world.graph.poses().begin(), world.graph.poses().end()) {
  for (int k = 0; k < world.store.size(); ++k) {
    serials_.push_back(world.store.serial(k));
  }
  for (const Constraint& each : world.graph.constraints()) {
    weights_.push_back(each.weight);
  }
}

bool WorldMirror::has_keyframes_of(const SubmapGraph& graph) const {
  const int mapped = graph.mapped_keyframes();
  return mapped == 0 || graph.keyframes().serial(mapped - 1) < next_serial();
}

int WorldMirror::keyframes_before(int serial) const {
  return static_cast<int>(std::ranges::lower_bound(serials_, serial) - serials_.begin());
}

void WorldMirror::forget_keyframes(int from_serial) {
  serials_.resize(static_cast<std::size_t>(keyframes_before(from_serial)));
}

bool WorldMirror::collect(const SubmapWorld& world, int keyframes, WorldChanges& changes) const {
  const KeyframeStore& store = world.store;
  collect_left_out(store, keyframes, changes);
  const bool is_anew = !changes.left_out.empty();
  int next = static_cast<int>(serials_.size() - changes.left_out.size() + changes.keyframes.size());
  const int most = next + kKeyframes_max;
  for (; next < std::min(keyframes, most); ++next) {
    const std::span<const BeamCode> codes = store.codes(next);
    changes.keyframes.push_back({store[next], {codes.begin(), codes.end()}, store.serial(next)});
  }
  const std::span<const Submap> submaps = world.submaps;
  changes.first_submap = is_anew ? 0 : static_cast<int>(poses_.size());
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
      changes.submaps.back().first_keyframe = store.serial(submap.first_keyframe);
    }
    if (is_new || !is_same(pose, poses_[static_cast<std::size_t>(count)])) {
      changes.moved.push_back({count, pose});
    }
  }
  collect_constraints(world.graph, count, is_anew ? std::span<const double>() : weights_, changes);
  return next < keyframes;
}

// Those that the world does not know yet, for they go to the file first, are none of these.
void WorldMirror::collect_left_out(const KeyframeStore& store, int keyframes, WorldChanges& changes) const {
  bool is_behind_gap = false;
  int next = 0;
  for (const int serial : serials_) {
    if (next == keyframes || serial > store.serial(next)) {
      return;
    }
    const bool is_gone = serial < store.serial(next);
    if (is_gone) {
      changes.left_out.push_back(serial);
    } else if (const int k = next++; is_behind_gap) {
      changes.ways.push_back({serial, store[k].since_last});
    }
    is_behind_gap = is_gone;
  }
}

void WorldMirror::collect_constraints(const PoseGraph& graph, int submaps, std::span<const double> known,
                                      WorldChanges& changes) {
  const std::span<const Constraint> constraints = graph.constraints();
  changes.first_constraint = static_cast<int>(known.size());
  for (std::size_t i = 0; i < constraints.size(); ++i) {
    const Constraint& each = constraints[i];
    if (i < known.size()) {
      if (each.weight != known[i]) {
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
  if (!changes.left_out.empty()) {
    std::erase_if(serials_, [&](int serial) { return std::ranges::binary_search(changes.left_out, serial); });
    poses_.clear();
    weights_.clear();
  }
  for (const StoredKeyframe& each : changes.keyframes) {
    serials_.push_back(each.serial);
  }
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
