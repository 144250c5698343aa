#pragma once

#include <CLI/CLI.hpp>

namespace odoless {

/// Adds `odoless ctl`: commands to a daemon on this machine.
void add_ctl(CLI::App& app);

/// Adds `odoless memory`: what a daemon with a configuration takes.
void add_memory(CLI::App& app);

}  // namespace odoless
