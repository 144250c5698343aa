#include "firmware/world/world_mirror.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>

namespace odoless {
namespace {

bool is_same(const Pose2& a, const Pose2& b) { return a.x_m == b.x_m && a.y_m == b.y_m && a.yaw_rad == b.yaw_rad; }

bool is_finite(const Pose2& pose) {
  return std::isfinite(pose.x_m) && std::isfinite(pose.y_m) && std::isfinite(pose.yaw_rad);
}

}  // namespace

WorldMirror::WorldMirror(const SubmapWorld& world)
    : serials_(static_cast<std::size_t>(world.store.size())),
      poses_(world.graph.poses().begin(), world.graph.poses().end()) {
  std::iota(serials_.begin(), serials_.end(), 0);
  for (const Constraint& each : world.graph.constraints()) {
    weights_.push_back(each.weight);
  }
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
  changes.first_keyframe = this->keyframes() - static_cast<int>(changes.left_out.size());
  int next = changes.first_keyframe + static_cast<int>(changes.keyframes.size());
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
  int next = 0;
  for (std::size_t i = 0; i < serials_.size() && serials_[i] < store.serial(keyframes); ++i) {
    if (next < keyframes && serials_[i] == store.serial(next)) {
      ++next;
    } else {
      changes.left_out.push_back(static_cast<int>(i));
    }
  }
  for (int k = 0; k < next && !changes.left_out.empty(); ++k) {
    if (const int before = k == 0 ? 0 : store.serial(k - 1) + 1; store.serial(k) != before) {
      changes.ways.push_back({k, store[k].since_last});
    }
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
    std::size_t stay = 0;
    auto gone = changes.left_out.begin();
    for (std::size_t i = 0; i < serials_.size(); ++i) {
      if (gone != changes.left_out.end() && static_cast<std::size_t>(*gone) == i) {
        ++gone;
      } else {
        serials_[stay++] = serials_[i];
      }
    }
    serials_.resize(stay);
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
