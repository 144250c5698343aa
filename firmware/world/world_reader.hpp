#pragma once

#include <memory>
#include <optional>
#include <string>

#include "config/robot_params.hpp"
#include "firmware/world/world_contents.hpp"
#include "firmware/world/world_file.hpp"

namespace odoless {

/// A world as it was read, or why it cannot be.
struct WorldReading {
  std::unique_ptr<StoredWorld> world{};  ///< null: `wrong` says why
  std::string wrong{};
};

/// Reads all of an open file, and holds each number to what a world can be. Keyframes that belong to no submap yet, as
/// after a power cut, are made into submaps as the graph would have; no match is done again.
/// @param params  How these are made.
[[nodiscard]] WorldReading read_world(WorldFile& file, const RobotParams& params);

/// Where the robot was last at a place that tells where it is (world_parts.hpp); none where the world has no submap.
[[nodiscard]] std::optional<PlaceBySubmap> last_place(const StoredWorld& world);

/// Submaps that are joined to one by constraints that hold, in their order.
[[nodiscard]] std::vector<int> connected_submaps(const PoseGraph& graph, int submap);

/// A world of some submaps alone, which keep their order. Keyframes are those of `world`, which must outlive it.
struct WorldPart {
  PoseGraph graph;
  std::vector<Submap> submaps;
  const KeyframeStore& store;

  [[nodiscard]] SubmapWorld world() const { return {store, graph, submaps}; }
};
[[nodiscard]] WorldPart part_of(const StoredWorld& world, const std::vector<int>& submaps);

}  // namespace odoless
