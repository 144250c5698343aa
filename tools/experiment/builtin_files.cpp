#include "tools/experiment/builtin_files.hpp"

#include <algorithm>

#include "core/base/check.hpp"

namespace odoless {

std::string_view builtin_file(std::string_view name) {
  const std::span<const BuiltinFile> files = builtin_files();
  const auto file = std::find_if(files.begin(), files.end(), [&](const BuiltinFile& f) { return f.name == name; });
  ODOLESS_CHECK(file != files.end());
  return file->text;
}

}  // namespace odoless
