#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>

#include "config/config.hpp"
#include "firmware/daemon/daemon_params.hpp"
#include "rt/cpu_clock.hpp"
#include "tools/command/emulate.hpp"
#include "tools/command/emulate_devices.hpp"
#include "tools/command/error.hpp"
#include "tools/emulate/emulated_gpio.hpp"
#include "tools/emulate/looped_gpio.hpp"
#include "tools/emulate/looped_recording.hpp"
#include "tools/emulate/lrf_emulator.hpp"
#include "tools/emulate/recorded_gpio.hpp"
#include "tools/emulate/traced_servo.hpp"
#include "tools/emulate/world_source.hpp"

namespace odoless {
namespace {

struct EmulateRobotOptions {
  std::string from_raw;
  std::string config;
  EmulateLrfOptions laser;
  EmulateServoOptions servo;
  std::string gpio;
  double pulse_delay_ms = 0.0;
  std::vector<std::string> gpio_faults;

  [[nodiscard]] bool has_servo() const { return !servo.can.empty() || !servo.pty.empty(); }
  [[nodiscard]] bool has_laser_line() const { return !laser.pty.empty() || laser.tcp_port >= 0 || laser.usbip; }
};

/// The laser's pulses: one at the start of each turn, or so long after it.
EmulatedGpio::PulseTime pulses_of(const EmulatedLaser& laser, std::int64_t delay_ns) {
  return [&laser, delay_ns](std::int64_t index) {
    constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::max();
    const auto source_time_ns = laser.device->source_time_ns(0);
    return source_time_ns ? laser.source->start_ns(index) - *source_time_ns + delay_ns : kNever;
  };
}

/// The servo tilts the laser of a world, as the robot's file says that they are mounted.
void tilt_laser(const EmulateRobotOptions& options, const EmulatedLaser& laser, TracedServo* servo) {
  if (options.config.empty()) {
    return;
  }
  auto* const world = dynamic_cast<WorldSource*>(laser.source.get());
  if (world == nullptr || servo == nullptr) {
    throw UsageError(
        "--config: only a servo can tilt, and only the laser of a world; expected --from WORLD.world and "
        "--servo-can or --servo-pty");
  }
  DaemonParams params;
  load_parameters(options.config, params);
  const double sense = params.tilt.inverted ? -1.0 : 1.0;
  world->tilt({TiltMount(params.mapping.mount),
               [servo, sense, level_rad = params.tilt.level_angle_rad, &device = *laser.device](std::int64_t time_ns) {
                 const std::int64_t host_ns = time_ns - device.source_time_ns(0).value_or(0);
                 return sense * (servo->angle_rad_at(host_ns) - level_rad);
               }});
}

void run_emulated(const EmulateRobotOptions& options) {
  const EmulatedLaser laser = make_laser(options.laser);
  EmulatedGpio gpio(gpio_faults(options.gpio_faults), pulses_of(laser, std::llround(options.pulse_delay_ms * 1e6)),
                    monotonic_ns());
  const auto servo = options.has_servo() ? std::make_unique<TracedServo>(make_servo(options.servo)) : nullptr;
  tilt_laser(options, laser, servo.get());
  const std::unique_ptr<ServoLine> servo_line = servo ? make_servo_line(options.servo) : nullptr;
  const std::unique_ptr<EmulatedLine> line = make_line(options.laser);
  say(fmt::format("{} on {}", laser.product, line->path()));

  LoopedLrf looped_laser(*laser.device, *laser.source, *line, options.laser.truth, [] { say("path done"); });
  std::vector<LoopedDevice*> devices{&looped_laser};
  std::optional<LoopedServo> looped_servo;
  if (servo) {
    devices.push_back(&looped_servo.emplace(*servo, *servo_line));
  }
  std::unique_ptr<GpioSimChip> chip;
  std::optional<LoopedGpio> looped_gpio;
  if (!options.gpio.empty()) {
    chip = make_robot_chip(options.gpio);
    devices.push_back(&looped_gpio.emplace(gpio, *chip, [&](GpioPin pin, bool high, std::int64_t now_ns) {
      if (pin == GpioPin::kPower) {
        laser.device->set_power(high, now_ns);
      }
    }));
  }
  serve_devices(devices, duration_ns(options.laser.duration_s), options.laser.stop_at_end);
  say(fmt::format("{} scans sent, {} dropped, {} pulses given", looped_laser.done().scans, looped_laser.done().dropped,
                  gpio.pulses()));
}

void tell_counts(const char* device, const RawPlayer& player) {
  const RawPlayCounts& counts = player.counts();
  say(fmt::format("{}: {} commands answered, {} more answered again, {} pieces sent, {} bytes passed over", device,
                  counts.answered, counts.repeated, counts.sent, counts.unknown));
}

void check_lines(const EmulateRobotOptions& options, const RawRecording& recording) {
  if (options.has_laser_line() == recording.laser.empty() || options.has_servo() == recording.servo.empty()) {
    throw UsageError(fmt::format("--from-raw {}: it has {} laser and {} servo; expected a line for each that it has",
                                 options.from_raw, recording.laser.empty() ? "no" : "a",
                                 recording.servo.empty() ? "no" : "a"));
  }
  if (options.has_servo() && recording.servo_is_on_can == options.servo.can.empty()) {
    throw UsageError(fmt::format("--from-raw {}: its servo is on {}", options.from_raw,
                                 recording.servo_is_on_can ? "CAN; expected --servo-can INTERFACE"
                                                           : "a serial line; expected --servo-pty PATH"));
  }
  if (!options.gpio.empty() && recording.gpio.empty()) {
    throw UsageError(fmt::format("--from-raw {}: it has no GPIO lines; expected no --gpio", options.from_raw));
  }
  if (options.gpio.empty() && recording.laser.empty() && recording.servo.empty()) {
    throw UsageError(fmt::format("--from-raw {}: it has GPIO lines alone; expected --gpio NAME", options.from_raw));
  }
}

/// When a change of the wires is due: together with the laser's bytes; without a laser with the servo's, and without
/// any from now on.
RecordedGpio::DueTime due_with(const RawRecording& recording, const RawPlayer& laser, const RawPlayer& servo) {
  if (recording.laser.empty() && recording.servo.empty()) {
    const std::int64_t offset_ns = monotonic_ns() - recording.gpio.front().time_us * 1000;
    return [offset_ns](std::int64_t recorded_us) { return recorded_us * 1000 + offset_ns; };
  }
  const RawPlayer& leader = recording.laser.empty() ? servo : laser;
  return [&leader](std::int64_t recorded_us) { return leader.due_ns(recorded_us); };
}

void run_recorded(const EmulateRobotOptions& options) {
  const RawRecording recording = read_raw_recording(options.from_raw);
  check_lines(options, recording);
  RawPlayer laser(recording.laser);
  RawPlayer servo(recording.servo, recording.servo_is_on_can ? sizeof(CanFrame) : 1);
  std::unique_ptr<ServoLine> laser_line;
  std::unique_ptr<ServoLine> servo_line;
  std::vector<std::unique_ptr<LoopedRecording>> looped;
  if (options.has_laser_line()) {
    std::unique_ptr<EmulatedLine> line = make_line(options.laser);
    say(fmt::format("recorded laser on {}", line->path()));
    laser_line = make_servo_stream(std::move(line));
    looped.push_back(std::make_unique<LoopedRecording>(laser, *laser_line));
  }
  if (options.has_servo()) {
    servo_line = make_servo_line(options.servo);
    say(fmt::format("recorded servo on {}", options.servo.can.empty() ? options.servo.pty : options.servo.can));
    looped.push_back(std::make_unique<LoopedRecording>(servo, *servo_line));
  }
  std::vector<LoopedDevice*> devices;
  std::transform(looped.begin(), looped.end(), std::back_inserter(devices), [](const auto& one) { return one.get(); });
  RecordedGpio wires(recording.gpio, due_with(recording, laser, servo), options.from_raw);
  std::unique_ptr<GpioSimChip> chip;
  std::optional<LoopedGpio> looped_gpio;
  if (!options.gpio.empty()) {
    chip = make_robot_chip(options.gpio);
    devices.push_back(&looped_gpio.emplace(wires, *chip, [](GpioPin, bool, std::int64_t) {}));
  }
  serve_devices(devices, duration_ns(options.laser.duration_s), options.laser.stop_at_end);
  tell_counts("laser", laser);
  tell_counts("servo", servo);
  say(fmt::format("wires: {} of {} changes played", wires.played(), wires.recorded()));
}

void add_servo_options(CLI::App& command, EmulateServoOptions& servo) {
  auto* const can = command.add_option("--servo-can", servo.can, "A CANopen drive tilts it, on this CAN interface");
  command.add_option("--servo-pty", servo.pty, "A Dynamixel tilts it; link to make to its line's end for the client")
      ->excludes(can);
  command.add_option("--servo-id", servo.id, "The servo's number on its bus")
      ->check(CLI::Range(1, 127))
      ->capture_default_str();
  command.add_option("--servo-start-deg", servo.start_deg, "Angle of the servo's axis at the start")
      ->check(CLI::Range(-90.0, 90.0))
      ->capture_default_str();
  command.add_option("--servo-fault", servo.faults,
                     fmt::format("{} since the servo was first spoken to, may be repeated", kFaultForm));
}

void run(EmulateRobotOptions& options) {
  options.servo.cia402 = !options.servo.can.empty();
  options.servo.dynamixel = !options.servo.pty.empty();
  if (options.from_raw.empty() == options.laser.from.empty()) {
    throw UsageError("expected one of --from WORLD|LOG and --from-raw LOG.lcm");
  }
  if (!options.from_raw.empty()) {
    return run_recorded(options);
  }
  if (!options.has_laser_line()) {
    throw UsageError("expected what the laser is on: one of --pty, --tcp and --usbip");
  }
  run_emulated(options);
}

}  // namespace

void add_emulate_robot(CLI::App& emulate) {
  auto options = std::make_shared<EmulateRobotOptions>();
  CLI::App* const command = emulate.add_subcommand(
      "robot", "A whole robot on one clock: laser, tilt servo, GPIO lines; from a world, a log, or recorded bytes");
  auto* const from = command->add_option("--from", options->laser.from,
                                         "World file (*.world), or a log of any kind that replay reads");
  command
      ->add_option("--from-raw", options->from_raw,
                   "LCM log of odolessd's recorder: the devices' own bytes are played, as the daemon asks for them")
      ->excludes(from);
  add_line_options(*command, options->laser, false);
  add_laser_options(*command, options->laser);
  add_servo_options(*command, options->servo);
  command->add_option("--config", options->config,
                      "Robot file: the servo tilts the laser of a world as its [tilt] and [mapping.mount] say, and the "
                      "laser sees the world in space [the servo tilts nothing]");
  command->add_option("--gpio", options->gpio,
                      "Name of a chip of gpio-sim for its wires: NAME-stop, NAME-sync, NAME-power, NAME-led (root)");
  command->add_option("--pulse-delay-ms", options->pulse_delay_ms, "From the start of the laser's turn to its pulse")
      ->check(CLI::Range(0.0, 1000.0))
      ->capture_default_str();
  command->add_option("--gpio-fault", options->gpio_faults,
                      fmt::format("{} since its start, may be repeated; KIND: stop, silence", kFaultForm));
  command->callback([options] { run(*options); });
}

}  // namespace odoless
