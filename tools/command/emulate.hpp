#pragma once

namespace CLI {
class App;
}

namespace odoless {

/// `odoless emulate lrf --from LOG|WORLD --pty PATH`: a laser range finder on a pseudo-terminal.
void add_emulate(CLI::App& app);

}  // namespace odoless
