#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include "rt/cpu_clock.hpp"
#include "tools/command/emulate.hpp"
#include "tools/command/emulate_devices.hpp"
#include "tools/command/error.hpp"
#include "tools/emulate/emulated_gpio.hpp"
#include "tools/emulate/looped_gpio.hpp"

namespace odoless {
namespace {

struct EmulateGpioOptions {
  std::string name = "odoless";
  double pulse_period_ms = 0.0;  ///< 0: no pulses
  double duration_s = 0.0;       ///< 0: for ever
  std::vector<std::string> faults;
};

EmulatedGpio::PulseTime even_pulses(double period_ms, std::int64_t start_ns) {
  if (period_ms <= 0.0) {
    return {};
  }
  const std::int64_t period_ns = std::llround(period_ms * 1e6);
  return [=](std::int64_t index) { return start_ns + index * period_ns; };
}

void run(const EmulateGpioOptions& options) {
  const std::int64_t start_ns = monotonic_ns();
  EmulatedGpio gpio(gpio_faults(options.faults), even_pulses(options.pulse_period_ms, start_ns), start_ns);
  const std::unique_ptr<GpioSimChip> chip = make_robot_chip(options.name);
  LoopedGpio looped(gpio, *chip, [&](GpioPin pin, bool high, std::int64_t now_ns) {
    say(fmt::format("{:.3f} {}-{} {}", static_cast<double>(now_ns - start_ns) * 1e-9, options.name,
                    kGpioPinNames.at(static_cast<std::size_t>(pin)), high ? "high" : "low"));
  });
  const std::array<LoopedDevice*, 1> devices{&looped};
  serve_devices(devices, duration_ns(options.duration_s), false);
  say(fmt::format("{} pulses given", gpio.pulses()));
}

}  // namespace

std::vector<Fault> gpio_faults(const std::vector<std::string>& texts) {
  std::vector<Fault> faults;
  for (const std::string& text : texts) {
    faults.push_back(parse_fault(text));
    if (faults.back().kind != FaultKind::kStop && faults.back().kind != FaultKind::kSilence) {
      throw UsageError(
          fmt::format("{}: not of GPIO lines; expected stop (the emergency stop is pressed) or silence (no "
                      "pulses), such as stop@10:2",
                      text));
    }
  }
  return faults;
}

std::unique_ptr<GpioSimChip> make_robot_chip(const std::string& name) {
  std::vector<std::string> lines;
  for (const char* const pin : kGpioPinNames) {
    lines.push_back(fmt::format("{}-{}", name, pin));
  }
  auto chip = std::make_unique<GpioSimChip>(name, lines);
  say(fmt::format("{}: {}", chip->device(), fmt::join(lines, ", ")));
  return chip;
}

void add_emulate_gpio(CLI::App& emulate) {
  auto options = std::make_shared<EmulateGpioOptions>();
  CLI::App* const command = emulate.add_subcommand(
      "gpio", "A robot's wires on a GPIO chip of the kernel's gpio-sim, until it is stopped (needs root)");
  command
      ->add_option("--name", options->name,
                   "Name of the chip; its lines are NAME-stop, NAME-sync, NAME-power, NAME-led")
      ->capture_default_str();
  command->add_option("--pulse-period-ms", options->pulse_period_ms, "Period of the laser's pulses; 0: none")
      ->check(CLI::Range(0.0, 60'000.0))
      ->capture_default_str();
  command->add_option("--duration-s", options->duration_s, "Stop after this time [SIGTERM stops it]")
      ->check(CLI::Range(0.001, 1e9));
  command->add_option("--fault", options->faults,
                      fmt::format("{} since its start, may be repeated; KIND: stop, silence", kFaultForm));
  command->callback([options] { run(*options); });
}

}  // namespace odoless
