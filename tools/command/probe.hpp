#pragma once

namespace CLI {
class App;
}

namespace odoless {

/// `odoless probe`: what is connected to this machine, and the configuration for it.
void add_probe(CLI::App& app);

}  // namespace odoless
