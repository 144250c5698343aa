#pragma once

#include <filesystem>
#include <string>

namespace odoless {

/// SHA-256 of a file's bytes as 64 lower-case hexadecimal digits, as sha256sum prints it.
/// @throws NoInputError, IoError.
[[nodiscard]] std::string sha256_of_file(const std::filesystem::path& path);

}  // namespace odoless
