#pragma once

#include <filesystem>
#include <string>

#include "core/grid/occupancy_map.hpp"

namespace odoless {

/// The map as the picture of a map_server: binary PGM, row 0 at the top, 0 occupied (65 % and more), 254 free (25 % and
/// less), 205 unknown or undecided. The map has at least one cell.
[[nodiscard]] std::string format_map_pgm(const OccupancyMap& map);

/// The YAML that belongs to it. With its thresholds a grey of 205 reads back as unknown.
[[nodiscard]] std::string format_map_yaml(const OccupancyMap& map, const std::string& image_name);

/// Writes map.pgm and map.yaml into a folder, each whole or not at all. @throws CannotCreateError, IoError.
void write_map(const std::filesystem::path& folder, const OccupancyMap& map);

/// Reads back what `write_map` wrote: cells are 100 % (occupied), 0 % (free) or unknown.
/// @throws NoInputError, IoError, and DataError where the files are of another make.
[[nodiscard]] OccupancyMap read_map(const std::filesystem::path& folder);

}  // namespace odoless
