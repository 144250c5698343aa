#include "tools/command/emulate.hpp"

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <memory>

#include "rt/cpu_clock.hpp"
#include "tools/command/emulate_devices.hpp"
#include "tools/command/error.hpp"
#include "tools/emulate/log_source.hpp"
#include "tools/emulate/lrf_emulator.hpp"
#include "tools/emulate/lrf_models.hpp"
#include "tools/emulate/pseudo_terminal.hpp"
#include "tools/emulate/tcp_server_line.hpp"
#include "tools/emulate/usbip_line.hpp"
#include "tools/emulate/world_source.hpp"
#include "tools/sim/world_file.hpp"

namespace odoless {
namespace {

EmulatedLrfModel model_of(const std::string& name) {
  const std::vector<EmulatedLrfModel> models = emulated_lrf_models();
  return *std::find_if(models.begin(), models.end(), [&](const EmulatedLrfModel& m) { return m.name == name; });
}

std::unique_ptr<EmulatedScans> make_source(const EmulateLrfOptions& options, const EmulatedLrfModel& model) {
  if (std::filesystem::path(options.from).extension() != ".world") {
    if (!options.truth.empty()) {
      throw UsageError("--truth: a log doesn't know where the robot truly was; expected --from WORLD.world");
    }
    return std::make_unique<LogSource>(model.period_ns, read_scan_log(options.from, {.topic = options.topic}),
                                       options.rate_ratio);
  }
  return std::make_unique<WorldSource>(
      model.period_ns, WorldDrive{.world = read_world(options.from),
                                  .start_delay_s = options.start_delay_s,
                                  .speed_ratio = options.rate_ratio,
                                  .noise_sd_m = options.noise_sd_m < 0.0 ? model.range_sd_m : options.noise_sd_m,
                                  .distortion = !options.at_once,
                                  .seed = options.seed});
}

EmulatedLrfOptions device_options(const EmulateLrfOptions& options) {
  EmulatedLrfOptions device{.faults = {},
                            .starts_at_once = options.start_at_once,
                            .counter_start_ms = options.counter_ms,
                            .seed = options.seed};
  for (const std::string& fault : options.faults) {
    device.faults.push_back(parse_fault(fault));
  }
  return device;
}

std::vector<std::string> lrf_names() {
  std::vector<std::string> names;
  for (const EmulatedLrfModel& model : emulated_lrf_models()) {
    names.push_back(model.name);
  }
  return names;
}

void add_time_options(CLI::App& command, EmulateLrfOptions& options) {
  command.add_option("--rate", options.rate_ratio, "How many times faster than its path or its log the robot moves")
      ->check(CLI::Range(0.01, 100.0))
      ->capture_default_str();
  command.add_option("--start-delay-s", options.start_delay_s, "How long the robot of a world stands before it drives")
      ->check(CLI::Range(0.0, 3600.0))
      ->capture_default_str();
  command.add_flag("--start-at-once", options.start_at_once,
                   "Start the drive at once, and not when the laser is asked for scans first");
  command.add_option("--duration-s", options.duration_s, "Stop after this time [SIGTERM stops it]")
      ->check(CLI::Range(0.001, 1e9));
  command.add_flag("--stop-at-end", options.stop_at_end, "Stop when the path or the log is over");
}

void run(const EmulateLrfOptions& options) {
  const EmulatedLaser laser = make_laser(options);
  const std::unique_ptr<EmulatedLine> line = make_line(options);
  say(fmt::format("{} on {}", laser.product, line->path()));
  LoopedLrf looped(*laser.device, *laser.source, *line, options.truth, [] { say("path done"); });
  const std::array<LoopedDevice*, 1> devices{&looped};
  serve_devices(devices, duration_ns(options.duration_s), options.stop_at_end);
  say(fmt::format("{} scans sent, {} dropped", looped.done().scans, looped.done().dropped));
}

void add_lrf(CLI::App& emulate) {
  auto options = std::make_shared<EmulateLrfOptions>();
  CLI::App* const command = emulate.add_subcommand("lrf",
                                                   "A laser range finder (Hokuyo, SICK, RPLIDAR, LDROBOT, YDLIDAR, "
                                                   "one's own) on a line of your choice, until it is stopped");
  command->add_option("--from", options->from, "World file (*.world), or a log of any kind that replay reads")
      ->required();
  add_line_options(*command, *options, true);
  add_laser_options(*command, *options);
  command->callback([options] { run(*options); });
}

}  // namespace

void say(const std::string& line) {
  fmt::print("{}\n", line);
  static_cast<void>(std::fflush(stdout));
}

std::int64_t duration_ns(double duration_s) {
  return duration_s > 0.0 ? std::llround(duration_s * 1e9) : std::numeric_limits<std::int64_t>::max();
}

std::unique_ptr<EmulatedLine> make_line(const EmulateLrfOptions& options) {
  if (options.usbip) {
    return std::make_unique<UsbipLine>(options.usb);
  }
  if (options.tcp_port >= 0) {
    return std::make_unique<TcpServerLine>(static_cast<std::uint16_t>(options.tcp_port));
  }
  return std::make_unique<PseudoTerminal>(options.pty);
}

EmulatedLaser make_laser(const EmulateLrfOptions& options) {
  const EmulatedLrfModel model = model_of(options.model);
  const EmulatedLrfOptions device = device_options(options);
  EmulatedLaser laser{.product = model.product, .source = make_source(options, model), .device = {}};
  laser.device = make_emulated_lrf(options.model, *laser.source, device, monotonic_ns());
  return laser;
}

void add_line_options(CLI::App& command, EmulateLrfOptions& options, bool is_required) {
  CLI::Option_group* const line = command.add_option_group("line", "What the laser is on");
  line->add_option("--pty", options.pty, "A pseudo-terminal: link to make to the line's end for the client");
  line->add_option("--tcp", options.tcp_port, "A network: port of 127.0.0.1 to listen on; 0: any that is free")
      ->check(CLI::Range(0, 65535));
  line->add_flag("--usbip", options.usbip, "USB of this machine, by the kernel's vhci_hcd (needs root)");
  line->require_option(is_required ? 1 : 0, 1);
  command.add_option("--usb-serial", options.usb.serial, "Serial number for --usbip")->capture_default_str();
}

void add_laser_options(CLI::App& command, EmulateLrfOptions& options) {
  command.add_option("--topic", options.topic, "Topic of the scans, where a log of messages has several");
  command.add_option("--model", options.model, "Laser to be")->check(CLI::IsMember(lrf_names()))->capture_default_str();
  add_time_options(command, options);
  command.add_option("--noise-sd-m", options.noise_sd_m, "Standard deviation of a world's ranges [the model's]")
      ->check(CLI::Range(0.0, 10.0));
  command.add_flag("--at-once", options.at_once,
                   "Cast all beams of a world's scan when the first is, and not each at its own time, as lasers do");
  const auto refuse_distortion = [] {
    throw UsageError(
        "--distortion: beams are cast at their own times now; expected nothing, or --at-once for the old way");
  };
  command.add_flag_callback("--distortion", refuse_distortion)->group("");
  command.add_option("--seed", options.seed, "Seed of the noise")->capture_default_str();
  command.add_option("--truth", options.truth,
                     "File for the true pose at each scan sent (TUM), stamped as odolessd does");
  command.add_option("--counter-ms", options.counter_ms, "What the device's clock shows at first; it wraps at 2^24")
      ->check(CLI::Range(0, (1 << 24) - 1));
  command.add_option("--fault", options.faults,
                     fmt::format("{} since the first stream, may be repeated; KIND: {}", kFaultForm, fault_names()));
}

void add_emulate(CLI::App& app) {
  CLI::App* const command = app.add_subcommand("emulate", "Be a device that isn't there");
  command->require_subcommand(1);
  add_lrf(*command);
  add_emulate_servo(*command);
  add_emulate_gpio(*command);
  add_emulate_robot(*command);
}

}  // namespace odoless
