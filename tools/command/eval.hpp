#pragma once

namespace CLI {
class App;
}

namespace odoless {

/// `odoless eval relations|ate|pairs`: how far an estimate is from a reference.
void add_eval(CLI::App& app);

}  // namespace odoless
