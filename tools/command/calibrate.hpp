#pragma once

namespace CLI {
class App;
}

namespace odoless {

/// Adds `odoless calibrate mount`: what a log tells of how the laser is mounted.
void add_calibrate(CLI::App& app);

}  // namespace odoless
