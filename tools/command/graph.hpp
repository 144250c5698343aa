#pragma once

namespace CLI {
class App;
}

namespace odoless {

/// `odoless graph solve FILE.g2o`: the solver of the pose graph, for graphs of any origin.
void add_graph(CLI::App& app);

}  // namespace odoless
