#pragma once

namespace CLI {
class App;
}

namespace odoless {

/// `odoless world info|check|export|compact`: world files.
void add_world(CLI::App& app);

}  // namespace odoless
