#pragma once

#include <optional>
#include <span>

#include "core/graph/keyframe_store.hpp"
#include "core/graph/pose_graph.hpp"
#include "core/graph/submap_builder.hpp"

namespace odoless {

/// The submaps of a world: where their keyframes are, and where they lie.
struct SubmapWorld {
  const KeyframeStore& store;
  const PoseGraph& graph;
  std::span<const Submap> submaps;
  std::optional<Pose2> map_T_odom{};  ///< of the keyframes behind the last submap; none: they are not of this world
};

/// Takes every keyframe in its order as (index, map_T_scan).
template <class Take>
void for_each_keyframe(const SubmapWorld& world, const Take& take) {
  int next = 0;
  for (std::size_t i = 0; i < world.submaps.size(); ++i) {
    for (next = world.submaps[i].first_keyframe; next < world.submaps[i].end_keyframe(); ++next) {
      take(next, world.graph.pose(static_cast<int>(i)) * world.store.submap_T_scan(next));
    }
  }
  for (; world.map_T_odom && next < world.store.size(); ++next) {
    take(next, *world.map_T_odom * world.store[next].odom_T_scan);
  }
}

}  // namespace odoless
