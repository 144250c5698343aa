#include "tools/command/probe.hpp"

#include <fmt/core.h>
#include <sysexits.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "tools/command/error.hpp"
#include "tools/probe/ask_lrf.hpp"
#include "tools/probe/connected.hpp"

namespace odoless {
namespace {

constexpr const char* kHokuyo = "15d1";

struct ProbeOptions {
  std::vector<std::string> addresses;
  bool quiet = false;
  int baud = 0;
  double patience_s = 3.0;
};

std::string sentence_of(const LrfGeometry& geometry) {
  constexpr double kDegPerRad = 180.0 / std::numbers::pi;
  return fmt::format("{} beams over {:.1f} deg, {:.2f} to {:.1f} m, {:.1f} Hz", geometry.beams,
                     (geometry.beams - 1) * std::abs(geometry.angle_step_rad) * kDegPerRad, geometry.range_min_m,
                     geometry.range_max_m, 1e9 / static_cast<double>(geometry.period_ns));
}

/// A protocol that a laser is asked in.
struct Protocol {
  LrfDriver driver;
  const char* name;
};
constexpr Protocol kScip{LrfDriver::kScip, "SCIP (Hokuyo)"};
/// In this order: SCIP's questions are plain text, an RPLIDAR answers within its first scan, and a SICK's rate must be
/// searched for.
constexpr std::array kProtocols{kScip, Protocol{LrfDriver::kRplidar, "RPLIDAR's protocol"},
                                Protocol{LrfDriver::kSick, "SICK's telegrams"}};

/// Asks the laser at that address in one protocol and prints its configuration. @return  kOk, or why there is none.
Errc ask(const std::string& address, const Protocol& protocol, const ProbeOptions& options,
         const std::string& alternative) {
  LrfParams params;
  params.driver = protocol.driver;
  params.device = address;
  params.baud = options.baud;
  const Result<LrfGeometry> answer = ask_lrf(params, std::llround(options.patience_s * 1e9));
  if (!answer.ok()) {
    fmt::print("#   no laser that speaks {} answers: {}\n", protocol.name, describe(answer.error()));
    return answer.error();
  }
  fmt::print("#   a laser that speaks {}: {}\n[lrf]\ndriver = \"{}\"\ndevice = \"{}\"\n", protocol.name,
             sentence_of(answer.value()), kLrfDriverNames[static_cast<std::size_t>(protocol.driver)], address);
  if (options.baud != 0) {
    fmt::print("baud = {}\n", options.baud);
  }
  if (!alternative.empty()) {
    fmt::print("# or, past the kernel's driver: device = \"{}\"\n", alternative);
  }
  return Errc::kOk;
}

/// Asks in one protocol after the other, until an answer comes. @return  Whether one did.
bool ask_all(const std::string& address, const ProbeOptions& options) {
  Errc error = Errc::kDeviceSilent;
  for (std::size_t i = 0; i < kProtocols.size() && error == Errc::kDeviceSilent; ++i) {
    error = ask(address, kProtocols.at(i), options, "");  // a line that cannot be opened is asked once
  }
  return error == Errc::kOk;
}

/// Only a laser by its USB vendor is asked: to another device the question may be a command.
void probe_serial(const SerialDevice& device, const ProbeOptions& options) {
  fmt::print("# {}{}{}\n", device.path,
             device.vendor.empty() ? "" : fmt::format(": {} ({}:{})", device.name, device.vendor, device.product),
             device.serial.empty() ? "" : ", serial number " + device.serial);
  if (device.vendor == kHokuyo && !options.quiet) {
    const std::string usb =
        fmt::format("usb://{}:{}{}{}", device.vendor, device.product, device.serial.empty() ? "" : "/", device.serial);
    static_cast<void>(ask(device.stable_path, kScip, options, usb));
  } else {
    fmt::print("#   not asked; to ask it: odoless probe {}\n", device.stable_path);
  }
}

void probe_all(const ProbeOptions& options) {
  const std::vector<SerialDevice> devices = connected_serial_devices();
  if (devices.empty()) {
    fmt::print("# no serial lines\n");
  }
  for (const SerialDevice& device : devices) {
    probe_serial(device, options);
  }
  for (const std::string& name : connected_can_interfaces()) {
    fmt::print("# CAN interface {}\n", name);
  }
  for (const std::string& name : connected_gpio_chips()) {
    fmt::print("# GPIO chip {} (its lines: gpioinfo {})\n", name, name);
  }
}

void run(const ProbeOptions& options) {
  if (options.addresses.empty()) {
    return probe_all(options);
  }
  int answers = 0;
  for (const std::string& address : options.addresses) {
    fmt::print("# {}\n", address);
    answers += ask_all(address, options) ? 1 : 0;
  }
  if (answers == 0) {
    throw UserError(EX_UNAVAILABLE, "no laser answers");
  }
}

}  // namespace

void add_probe(CLI::App& app) {
  const auto options = std::make_shared<ProbeOptions>();
  CLI::App* const command =
      app.add_subcommand("probe", "List what is connected to this machine, with the configuration for it (TOML)");
  command->add_option("ADDRESS", options->addresses,
                      "Ask these instead, in every protocol: paths, tcp://ADDRESS:PORT, usb://VENDOR:PRODUCT[/SERIAL]");
  command->add_flag("--quiet", options->quiet, "Send nothing to any device");
  command->add_option("--baud", options->baud, "Rate of serial lines")->check(CLI::Range(0, 4'000'000));
  command->add_option("--patience-s", options->patience_s, "How long a laser may take to answer, in each protocol")
      ->check(CLI::Range(0.1, 60.0))
      ->capture_default_str();
  command->callback([options] { run(*options); });
}

}  // namespace odoless
