#pragma once

namespace CLI {
class App;
}

namespace odoless {

/// Has every option and argument of a command line, and of its sub-commands, refuse a value without a character: the
/// built-in configuration is what one gets without --config, not what a script gets whose variable is empty. To be
/// called when all are defined.
void refuse_empty_values(CLI::App& app);

}  // namespace odoless
