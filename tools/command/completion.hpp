#pragma once

#include <string>

namespace CLI {
class App;
}

namespace odoless {

/// A script by which a shell completes the commands and options of a program; elsewhere it completes file names.
[[nodiscard]] std::string bash_completion(const CLI::App& program);
[[nodiscard]] std::string zsh_completion(const CLI::App& program);

/// `odoless completion bash|zsh`: such a script, of odoless and odolessd.
void add_completion(CLI::App& app);

}  // namespace odoless
