#pragma once

#include <filesystem>
#include <span>
#include <vector>

#include "core/geometry/pose2.hpp"
#include "core/grid/occupancy_map.hpp"
#include "tools/output/canvas.hpp"

namespace odoless {

struct ColouredPath {
  std::vector<Pose2> poses;  ///< map frame
  Rgb rgb;
};

/// The known part of a map with a margin: darker is more surely occupied, mid-grey is unknown. Paths lie over it in
/// their order, a disc at the start of each; beneath it a bar of 5 or 10 m. What lies off the picture is not drawn. The
/// map has at least one cell; the picture is at most 4096 pixels wide and high, whatever the map's size.
[[nodiscard]] Canvas draw_map(const OccupancyMap& map, std::span<const ColouredPath> paths);

/// Writes that picture as PNG, whole or not at all. @throws CannotCreateError, IoError.
void write_map_picture(const std::filesystem::path& path, const OccupancyMap& map, std::span<const ColouredPath> paths);

}  // namespace odoless
