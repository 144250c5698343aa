#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "tools/sim/world.hpp"

namespace odoless {

/// Reads a world file; tools/worlds/README.md describes the format.
/// @throws NoInputError when it cannot be opened, IoError when it cannot be read, and what parse_world throws.
[[nodiscard]] World read_world(const std::filesystem::path& file);

/// The same for a text in memory; `name` stands in messages.
/// @throws DataError with the line for an unknown statement, a wrong count or value, a door that opens no wall, and a
///         leg of the path that runs through a surface.
[[nodiscard]] World parse_world(std::string_view text, const std::string& name);

/// One line per statement, for help texts.
[[nodiscard]] std::string world_statements();

}  // namespace odoless
