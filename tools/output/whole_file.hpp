#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace odoless {

/// Writes a file that appears whole or not at all: to `path`.tmp first, which then takes its place.
/// @throws CannotCreateError, IoError, both with the path and the system's reason; nothing is left behind then.
void write_whole_file(const std::filesystem::path& path, std::string_view bytes);

/// All bytes of a file. @throws NoInputError, IoError.
[[nodiscard]] std::string read_whole_file(const std::filesystem::path& path);

/// Makes a folder for results, with its parents, unless it is there. @throws CannotCreateError.
void make_output_folder(const std::filesystem::path& folder);

}  // namespace odoless
