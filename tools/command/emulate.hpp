#pragma once

namespace CLI {
class App;
}

namespace odoless {

/// `odoless emulate lrf --from LOG|WORLD --pty PATH`: a laser range finder on a pseudo-terminal.
void add_emulate(CLI::App& app);

/// `odoless emulate servo --dynamixel --pty PATH`, `odoless emulate servo --cia402 --can INTERFACE`: a tilt servo.
void add_emulate_servo(CLI::App& emulate);

/// `odoless emulate gpio --name NAME`: a robot's wires, on a chip of Linux's gpio-sim.
void add_emulate_gpio(CLI::App& emulate);

/// `odoless emulate robot --from WORLD|LOG`, or `--from-raw LOG.lcm`: all of these on one clock.
void add_emulate_robot(CLI::App& emulate);

}  // namespace odoless
