#pragma once

#include <string>

namespace CLI {
class App;
}

namespace odoless {

/// The manual page of a program, in section 1 or 8, from what its --help is made of.
[[nodiscard]] std::string manual_page(const CLI::App& program, int section);

/// `odoless manual [odolessd]`: the manual page of either program, for `man -l -`.
void add_manual(CLI::App& app);

}  // namespace odoless
