#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <memory>
#include <numbers>

#include "rt/cpu_clock.hpp"
#include "tools/command/emulate.hpp"
#include "tools/command/emulate_devices.hpp"
#include "tools/command/error.hpp"
#include "tools/emulate/cia402_device.hpp"
#include "tools/emulate/dynamixel_device.hpp"
#include "tools/emulate/maestro_device.hpp"
#include "tools/emulate/pseudo_terminal.hpp"

namespace odoless {
namespace {

double radians(double degrees) { return degrees * std::numbers::pi / 180.0; }

std::vector<Fault> servo_faults(const std::vector<std::string>& texts) {
  constexpr std::array kKinds{FaultKind::kSilence, FaultKind::kWrongSum, FaultKind::kReboot,
                              FaultKind::kDrift,   FaultKind::kStall,    FaultKind::kError};
  std::vector<Fault> faults;
  for (const std::string& text : texts) {
    faults.push_back(parse_fault(text));
    if (std::find(kKinds.begin(), kKinds.end(), faults.back().kind) == kKinds.end()) {
      throw UsageError(
          fmt::format("--fault {}: not of a servo; expected silence, wrong-sum, reboot, drift, stall or error", text));
    }
  }
  return faults;
}

std::string servo_names() {
  std::string names;
  for (const DynamixelModel& model : dynamixel_models()) {
    names += (names.empty() ? "" : " or ") + std::string(model.name);
  }
  return names;
}

void run(const EmulateServoOptions& options, double duration_s) {
  const bool is_serial = options.dynamixel != options.maestro;
  const bool is_one =
      static_cast<int>(options.cia402) + static_cast<int>(options.dynamixel) + static_cast<int>(options.maestro) == 1;
  if (!is_one || options.cia402 == options.can.empty() || is_serial == options.pty.empty()) {
    throw UsageError("expected one of --cia402 --can INTERFACE, --dynamixel --pty PATH and --maestro --pty PATH");
  }
  const std::unique_ptr<EmulatedServo> servo = make_servo(options);
  const std::unique_ptr<ServoLine> line = make_servo_line(options);
  say(fmt::format("{}: {} number {}", options.cia402 ? options.can : options.pty,
                  options.cia402    ? "CiA 402 drive"
                  : options.maestro ? "Maestro, channel"
                                    : "Dynamixel " + options.model,
                  options.maestro ? options.channel : options.id));
  LoopedServo looped(*servo, *line);
  const std::array<LoopedDevice*, 1> devices{&looped};
  serve_devices(devices, duration_ns(duration_s), false);
  say(fmt::format("axis at {:.2f} deg", servo->angle_rad() * 180.0 / std::numbers::pi));
}

}  // namespace

std::unique_ptr<EmulatedServo> make_servo(const EmulateServoOptions& options) {
  if (options.cia402) {
    Cia402DeviceOptions device;
    device.node = options.id;
    device.counts_per_turn = options.counts_per_turn;
    device.start_rad = radians(options.start_deg);
    device.home_rad = radians(options.home_deg);
    device.faults = servo_faults(options.faults);
    return std::make_unique<Cia402Device>(std::move(device), monotonic_ns());
  }
  if (options.maestro) {
    MaestroDeviceOptions device;
    device.channel = options.channel;
    device.start_rad = radians(options.start_deg);
    device.faults = servo_faults(options.faults);
    return std::make_unique<MaestroDevice>(std::move(device), monotonic_ns());
  }
  const DynamixelModel* const model = find_dynamixel_model(options.model);
  if (model == nullptr) {
    throw UsageError(fmt::format("--model {}: no Dynamixel of that name; expected {}", options.model, servo_names()));
  }
  DynamixelDeviceOptions device;
  device.model = model->name;
  device.id = options.id;
  device.start_rad = radians(options.start_deg);
  device.echoes = options.echoes;
  device.faults = servo_faults(options.faults);
  return std::make_unique<DynamixelDevice>(std::move(device), monotonic_ns());
}

std::unique_ptr<ServoLine> make_servo_line(const EmulateServoOptions& options) {
  return options.can.empty() ? make_servo_stream(std::make_unique<PseudoTerminal>(options.pty))
                             : make_servo_can(options.can, options.log);
}

void add_emulate_servo(CLI::App& emulate) {
  auto options = std::make_shared<EmulateServoOptions>();
  auto duration_s = std::make_shared<double>(0.0);  // 0: for ever
  CLI::App* const command = emulate.add_subcommand("servo", "A servo that tilts the laser, until it is stopped");
  command->add_flag("--cia402", options->cia402, "A CANopen drive (CiA 402)");
  command->add_flag("--dynamixel", options->dynamixel, "A Dynamixel of the X or P series (Protocol 2.0)");
  command->add_option("--model", options->model, "Dynamixel: xm430-w350 or ph54-200-s500")->capture_default_str();
  command->add_flag("--maestro", options->maestro, "An RC servo at a Pololu Maestro (compact protocol)");
  command->add_option("--channel", options->channel, "Maestro: where the servo is plugged in")
      ->check(CLI::Range(0, 5))
      ->capture_default_str();
  command->add_option("--can", options->can, "CAN interface to be on");
  command->add_option("--pty", options->pty, "Link to make to the line's end for the client");
  command->add_option("--log", options->log, "File for all frames on the CAN interface (candump -L)");
  command->add_option("--id", options->id, "Its number on the bus")->check(CLI::Range(1, 127))->capture_default_str();
  command->add_option("--start-deg", options->start_deg, "Angle of the axis at the start")
      ->check(CLI::Range(-90.0, 90.0))
      ->capture_default_str();
  command->add_option("--home-deg", options->home_deg, "Drive: angle at which homing finds the zero")
      ->check(CLI::Range(-90.0, 90.0))
      ->capture_default_str();
  command->add_option("--counts-per-turn", options->counts_per_turn, "Drive: position units per turn")
      ->check(CLI::Range(16.0, 268'435'456.0))
      ->capture_default_str();
  command->add_flag("--echoes", options->echoes, "Dynamixel: send back what comes, as half-duplex adapters do");
  command->add_option("--duration-s", *duration_s, "Stop after this time [SIGTERM stops it]")
      ->check(CLI::Range(0.001, 1e9));
  command->add_option("--fault", options->faults,
                      "KIND[=VALUE]@SECONDS[:DURATION] since it was first spoken to, may be repeated; KIND: silence, "
                      "wrong-sum, reboot, drift=PPM, stall, error=CODE");
  command->callback([options, duration_s] { run(*options, *duration_s); });
}

}  // namespace odoless
