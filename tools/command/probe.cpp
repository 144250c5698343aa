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

#include "drivers/io/device_address.hpp"
#include "drivers/io/device_advice.hpp"
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

std::string sentence_of(const LrfAnswer& answer) {
  constexpr double kDegPerRad = 180.0 / std::numbers::pi;
  const LrfGeometry& geometry = answer.geometry;
  const bool rate_is_known = answer.params.driver != LrfDriver::kSick || answer.params.baud != 0;
  return fmt::format("{} beams over {:.1f} deg, {:.2f} to {:.1f} m, {:.1f} Hz{}", geometry.beams,
                     (geometry.beams - 1) * std::abs(geometry.angle_step_rad) * kDegPerRad, geometry.range_min_m,
                     geometry.range_max_m, 1e9 / static_cast<double>(geometry.period_ns),
                     rate_is_known ? "" : " or more");
}

constexpr double kScansMaxHz = 60.0;  ///< of which every one is of use

/// A protocol that a laser is asked in, and the rate that it is asked for.
struct Protocol {
  LrfDriver driver;
  const char* name;
  int baud = 0;
  double patience_s = 1e9;  ///< at most
  bool is_for_networks = false;
};
constexpr Protocol kScip{LrfDriver::kScip, "SCIP (Hokuyo)"};
/// In this order: SCIP's questions are plain text, an LDROBOT and some YDLIDARs speak unasked, an RPLIDAR answers
/// within its first scan, and a SICK's rate must be searched for; SICK's other lasers are on networks. A Hokuyo on USB
/// has no rate; only one that is asked for a rate is searched for at all of them.
constexpr std::array kProtocols{kScip,
                                Protocol{LrfDriver::kScip, "SCIP at the rates of RS-232", 115200},
                                Protocol{LrfDriver::kSopas, "SOPAS (SICK TiM, LMS1xx, LMS4xxx)", 0, 1e9, true},
                                Protocol{LrfDriver::kCsv, "lines of text", 0, 2.0, true},
                                Protocol{LrfDriver::kLdrobot, "LDROBOT's packets", 0, 1.0},
                                Protocol{LrfDriver::kYdlidar, "YDLIDAR's packets", 0, 3.0},
                                Protocol{LrfDriver::kRplidar, "RPLIDAR's protocol"},
                                Protocol{LrfDriver::kSick, "SICK's telegrams"}};

/// @param alternative  Another address of the same laser; empty: none.
void print_configuration(const LrfAnswer& answer, const std::string& alternative) {
  const LrfParams& params = answer.params;
  fmt::print("[lrf]\ndriver = \"{}\"\ndevice = \"{}\"\n", kLrfDriverNames[static_cast<std::size_t>(params.driver)],
             params.device);
  if (!alternative.empty()) {
    fmt::print("# or, past the kernel's driver: device = \"{}\"\n", alternative);
  }
  if (params.baud != 0) {
    fmt::print("baud = {}\n", params.baud);
  }
  const double rate_hz = 1e9 / static_cast<double>(answer.geometry.period_ns);
  if (params.driver == LrfDriver::kSopas && rate_hz > kScansMaxHz) {
    fmt::print("skip = {}  # one scan of so many and one: the daemon does with some {:.0f} a second\n",
               std::min(static_cast<int>(std::ceil(rate_hz / kScansMaxHz)) - 1, 9), kScansMaxHz);
  }
  if (params.driver == LrfDriver::kYdlidar) {
    fmt::print(
        "ydlidar_ranging = \"triangle\"  # \"time_of_flight\" for a TG or TX, which nothing in its packets tells\n");
  }
  if (params.driver != LrfDriver::kSick) {
    return;
  }
  if (params.baud == 0) {
    fmt::print(
        "# baud = 9600, or what the far end's line has: without it, stamps are late by the time a scan takes on it\n");
  }
  fmt::print("sick_variant = \"{}\"\nsick_unit = \"{}\"\n",
             kSickVariantNames[static_cast<std::size_t>(params.sick_variant)],
             kSickUnitNames[static_cast<std::size_t>(params.sick_unit)]);
  if (answer.is_to_be_written) {
    fmt::print("# its measuring mode is another than the daemon's, which writes it to the laser's memory once\n");
  }
}

/// Asks the laser at that address in one protocol and prints its configuration. @return  kOk, or why there is none.
Errc ask(const std::string& address, const Protocol& protocol, const ProbeOptions& options,
         const std::string& alternative) {
  LrfParams params;
  params.driver = protocol.driver;
  params.device = address;
  params.baud = options.baud != 0 ? options.baud : protocol.baud;
  const double patience_s = std::min(options.patience_s, protocol.patience_s);
  const Result<LrfAnswer> asked = ask_lrf(params, std::llround(patience_s * 1e9));
  if (!asked.ok()) {
    fmt::print("#   no laser that speaks {} answers: {}\n", protocol.name, device_error_text(asked.error(), address));
    return asked.error();
  }
  const LrfAnswer& answer = asked.value();
  if (answer.has_scanned) {
    fmt::print("#   a laser that speaks {}: {}\n", protocol.name, sentence_of(answer));
  } else {
    fmt::print("#   a laser that speaks {}: it answers, but no scan came within {} s; does its motor turn?\n",
               protocol.name, patience_s);
  }
  print_configuration(answer, alternative);
  return Errc::kOk;
}

/// Asks in one protocol after the other, until an answer comes. @return  Whether one did.
bool ask_all(const std::string& address, const ProbeOptions& options) {
  const bool rate_is_wanted = options.baud == 0 && is_serial(address);
  Errc error = Errc::kDeviceSilent;
  for (const Protocol& protocol : kProtocols) {
    const bool fits = protocol.is_for_networks ? !is_serial(address) : protocol.baud == 0 || rate_is_wanted;
    if (error == Errc::kDeviceSilent && fits) {
      error = ask(address, protocol, options, "");  // a line that cannot be opened is asked once
    }
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
                      "Ask these instead, in every protocol: paths, tcp://ADDRESS:PORT, usb://VENDOR:PRODUCT[/SERIAL], "
                      "udp://ADDRESS:PORT");
  command->add_flag("--quiet", options->quiet, "Send nothing to any device");
  command->add_option("--baud", options->baud, "Rate of serial lines; 0: searched for")
      ->check(CLI::Range(0, 4'000'000));
  command
      ->add_option("--patience-s", options->patience_s,
                   "How long a laser may take to answer in each protocol, and then to its first scan")
      ->check(CLI::Range(0.1, 60.0))
      ->capture_default_str();
  command->callback([options] { run(*options); });
}

}  // namespace odoless
