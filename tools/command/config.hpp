#pragma once

#include <span>
#include <string_view>

namespace CLI {
class App;
}

namespace odoless {

/// The keys that robots differ in: those of the file to begin with. Whoever needs another finds it in the reference.
[[nodiscard]] std::span<const std::string_view> common_keys();

/// `odoless config reference|defaults`: every parameter with its range and meaning; a file to begin with.
void add_config(CLI::App& app);

}  // namespace odoless
