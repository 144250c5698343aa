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
  int anchor = 0;                     ///< a submap that the map is of

  /// Whether it is joined to the anchor, which may be a submap that is not there yet: where others lie is not known.
  [[nodiscard]] bool has(int submap) const {
    return anchor < graph.size() && graph.component(submap) == graph.component(anchor);
  }
};

/// A pose by a submap that it is near to: it holds in whichever frame the submap lies.
struct PlaceBySubmap {
  int submap = 0;
  Pose2 submap_T_scan{};
};

/// The submaps before and after one on its own path; a world that is held ends where it is held.
template <class Take>
void for_each_neighbour(const PoseGraph& graph, int submap, const Take& take) {
  if (graph.follows(submap) && submap != graph.held()) {
    take(submap - 1);
  }
  if (submap + 1 < graph.size() && graph.follows(submap + 1) && submap + 1 != graph.held()) {
    take(submap + 1);
  }
}

/// Takes every keyframe of the world in its order as (index, map_T_scan).
template <class Take>
void for_each_keyframe(const SubmapWorld& world, const Take& take) {
  int next = 0;
  for (std::size_t i = 0; i < world.submaps.size(); ++i) {
    const int submap = static_cast<int>(i);
    for (next = world.submaps[i].first_keyframe; next < world.submaps[i].end_keyframe(); ++next) {
      if (world.has(submap)) {
        take(next, world.graph.pose(submap) * world.store.submap_T_scan(next));
      }
    }
  }
  for (; world.map_T_odom && next < world.store.size(); ++next) {
    take(next, *world.map_T_odom * world.store[next].odom_T_scan);
  }
}

}  // namespace odoless
