#include "tools/command/config.hpp"

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <array>
#include <memory>
#include <string>

#include "config/config.hpp"
#include "core/match/ndt_matcher.hpp"
#include "firmware/daemon/daemon_params.hpp"

namespace odoless {
namespace {

constexpr std::array<std::string_view, 40> kCommonKeys{
    "lrf.driver",
    "lrf.device",
    "lrf.baud",
    "lrf.deskew",
    "lrf.sick_variant",
    "lrf.sick_unit",
    "lrf.rplidar_scan",
    "lrf.ydlidar_ranging",
    "lrf.mount.x_m",
    "lrf.mount.y_m",
    "lrf.mount.yaw_deg",
    "lrf.mount.upside_down",
    "lrf.mount.ignore",
    "gpio.stop_line",
    "gpio.stop_level",
    "tilt.driver",
    "tilt.device",
    "tilt.id",
    "tilt.at_start",
    "tilt.level_angle_deg",
    "tilt.inverted",
    "tilt.limit_min_deg",
    "tilt.limit_max_deg",
    "mapping.save_as",
    "mapping.mount.robot_T_tilt.z_m",
    "lcm.url",
    "lcm.ttl",
    "lcm.prefix",
    "recorder.path",
    "control.socket",
    "web.listen",
    "robot.speed_max_mps",
    "robot.turn_rate_max_degps",
    "scan.range_min_m",
    "scan.range_max_m",
    "slam.low.particles",
    "slam.low.grid.resolution_m",
    "slam.low.grid.width_m",
    "slam.low.grid.height_m",
    "graph.enabled",
};

struct DefaultsJob {
  bool all = false;
  std::string preset = "default";
};

void print_defaults(const DefaultsJob& job) {
  DaemonParams params;
  if (job.preset == "seed") {
    params.robot.matcher = seed_matcher_params();
  }
  if (job.all || job.preset != "default") {
    fmt::print("{}", write_toml(params));
    return;
  }
  fmt::print(
      "# A configuration of odoless, to begin with: remove the # before what your robot has otherwise.\n"
      "# `odoless config reference` explains these keys and all others.\n\n{}",
      write_template(params, kCommonKeys));
}

}  // namespace

std::span<const std::string_view> common_keys() { return kCommonKeys; }

void add_config(CLI::App& app) {
  CLI::App* const config = app.add_subcommand("config", "What a configuration file can say");
  config->require_subcommand(1);
  config->add_subcommand("reference", "Every key with its default, range and meaning, as Markdown")->callback([] {
    fmt::print("{}", write_reference(DaemonParams{}));
  });
  const auto job = std::make_shared<DefaultsJob>();
  CLI::App* const defaults = config->add_subcommand("defaults", "A configuration file to begin with");
  defaults->add_flag("--all", job->all, "Every key, as built in to the last digit");
  defaults
      ->add_option("--preset", job->preset, "default, or seed: plain Differential Evolution with N = 100 and G = 50")
      ->check(CLI::IsMember({"default", "seed"}))
      ->capture_default_str();
  defaults->callback([job] { print_defaults(*job); });
}

}  // namespace odoless
