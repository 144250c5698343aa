#pragma once

namespace CLI {
class App;
}

namespace odoless {

/// `odoless experiment NAME|all --out DIR`: an experiment of the dissertation with its figures, or all with one report.
void add_experiment(CLI::App& app);

}  // namespace odoless
