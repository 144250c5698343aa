#pragma once

namespace CLI {
class App;
}

namespace odoless {

/// `odoless emulate lrf --from LOG|WORLD --pty PATH`: a laser range finder on a pseudo-terminal.
void add_emulate(CLI::App& app);

/// `odoless emulate servo --dynamixel --pty PATH`, `odoless emulate servo --cia402 --can INTERFACE`: a tilt servo.
void add_emulate_servo(CLI::App& emulate);

}  // namespace odoless
