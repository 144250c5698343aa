#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "tools/emulate/emulated_line.hpp"
#include "tools/emulate/emulated_lrf.hpp"
#include "tools/emulate/gpio_sim_chip.hpp"
#include "tools/emulate/servo_line.hpp"
#include "tools/emulate/usbip_line.hpp"

namespace CLI {
class App;
}

/// What `odoless emulate lrf`, `servo`, `gpio` and `robot` share.
namespace odoless {

inline constexpr const char* kFaultForm = "KIND[=VALUE]@SECONDS[:DURATION]";

struct EmulateLrfOptions {
  std::string from;
  std::string topic;  ///< of the scans in the log
  std::string pty;
  int tcp_port = -1;  ///< -1: not on a network
  bool usbip = false;
  UsbIdentity usb;
  std::string model = "utm-30lx";
  std::string truth;
  double rate_ratio = 1.0;
  double noise_sd_m = -1.0;  ///< negative: the model's
  double start_delay_s = 0.0;
  double duration_s = 0.0;  ///< 0: for ever
  std::uint64_t seed = 1;
  std::uint32_t counter_ms = 0;
  bool at_once = false;  ///< all beams of a scan
  bool start_at_once = false;
  bool stop_at_end = false;
  std::vector<std::string> faults;
};

struct EmulateServoOptions {
  bool cia402 = false;
  bool dynamixel = false;
  bool maestro = false;
  std::string model = "xm430-w350";
  std::string can;
  std::string pty;
  std::string log;
  int id = 1;
  int channel = 0;
  double start_deg = 10.0;
  double home_deg = 0.0;
  double counts_per_turn = 65'536.0;
  bool echoes = false;
  std::vector<std::string> faults;
};

/// A laser with what it needs.
struct EmulatedLaser {
  std::string product;
  std::unique_ptr<EmulatedScans> source;
  std::unique_ptr<EmulatedLrf> device;
};

void add_line_options(CLI::App& command, EmulateLrfOptions& options, bool is_required);
/// Model, time, world, truth and faults; not where scans come from, nor the line.
void add_laser_options(CLI::App& command, EmulateLrfOptions& options);

/// @throws UserError
[[nodiscard]] std::unique_ptr<EmulatedLine> make_line(const EmulateLrfOptions& options);
[[nodiscard]] EmulatedLaser make_laser(const EmulateLrfOptions& options);
[[nodiscard]] std::unique_ptr<EmulatedServo> make_servo(const EmulateServoOptions& options);
[[nodiscard]] std::unique_ptr<ServoLine> make_servo_line(const EmulateServoOptions& options);
[[nodiscard]] std::vector<Fault> gpio_faults(const std::vector<std::string>& texts);
/// A chip whose lines are NAME-stop, NAME-sync, NAME-power and NAME-led.
[[nodiscard]] std::unique_ptr<GpioSimChip> make_robot_chip(const std::string& name);

[[nodiscard]] std::int64_t duration_ns(double duration_s);
/// Writes a line at once, for a script that waits for it.
void say(const std::string& line);

}  // namespace odoless
