#pragma once

namespace CLI {
class App;
}

namespace odoless {

/// `odoless cloud`: a 3D map from a tilt log or a simulated building.
void add_cloud(CLI::App& app);

}  // namespace odoless
