#pragma once

#include <span>
#include <string_view>

namespace odoless {

/// A file of the source tree that is part of the program, so that an experiment needs nothing beside it.
struct BuiltinFile {
  std::string_view name;
  std::string_view text;
};

/// The worlds of tools/worlds and the dissertation's configurations; generated when the program is built.
[[nodiscard]] std::span<const BuiltinFile> builtin_files();

/// The text of one of them. It is a bug to ask for another.
[[nodiscard]] std::string_view builtin_file(std::string_view name);

}  // namespace odoless
