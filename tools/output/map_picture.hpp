#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "core/graph/pose_graph.hpp"
#include "core/grid/occupancy_map.hpp"
#include "tools/output/plan.hpp"

namespace odoless {

/// The known part of a map with a margin, as a plan: darker is more surely occupied, mid-grey is unknown. Paths lie
/// over it in their order, a disc at the start of each. The map has at least one cell; the drawing is at most 4096
/// pixels wide and high, whatever the map's size.
[[nodiscard]] Drawing draw_map(const OccupancyMap& map, std::span<const ColouredPath> paths,
                               const std::string& title = "");

/// Writes that picture as PNG, and beside it as SVG, each whole or not at all. @throws CannotCreateError, IoError.
void write_map_picture(const std::filesystem::path& path, const OccupancyMap& map, std::span<const ColouredPath> paths,
                       const std::string& title);

/// Writes map and pose graph likewise: loop closures that hold, each from the older submap, under the way from submap
/// to submap.
void write_graph_picture(const std::filesystem::path& path, const OccupancyMap& map, const PoseGraph& graph,
                         const std::string& title);

}  // namespace odoless
