#pragma once

namespace CLI {
class App;
}

namespace odoless {

/// `odoless info [LOG] [--config C] [--json]`: what a recorded log holds, and how laser and tilt servo are mounted.
void add_info(CLI::App& app);

}  // namespace odoless
