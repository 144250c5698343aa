#pragma once

namespace CLI {
class App;
}

namespace odoless {

/// `odoless sim WORLD --out LOG`: a log of a simulated laser on its way through a world, and its true poses.
void add_sim(CLI::App& app);

}  // namespace odoless
