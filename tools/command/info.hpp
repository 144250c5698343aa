#pragma once

namespace CLI {
class App;
}

namespace odoless {

/// `odoless info LOG [--json]`: what a recorded log holds.
void add_info(CLI::App& app);

}  // namespace odoless
