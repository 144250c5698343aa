#include "tools/command/sim.hpp"

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>

#include "tools/command/error.hpp"
#include "tools/command/parameter_options.hpp"
#include "tools/output/whole_file.hpp"
#include "tools/sim/simulation.hpp"
#include "tools/sim/world_file.hpp"

namespace odoless {
namespace {

/// Some 2 GB of text.
constexpr double kRangeCountMax = 3e8;

struct SimOptions {
  std::string world;
  std::string log;
  std::string truth;
  std::uint64_t seed = 1;
  SimulatedLrfParams lrf;
};

std::string truth_file(const SimOptions& options) {
  return options.truth.empty() ? std::filesystem::path(options.log).replace_extension(".truth.tum").string()
                               : options.truth;
}

void check_size(const World& world, const SimulatedLrfParams& lrf) {
  const double range_count = Path(world.waypoints).duration_s() * lrf.rate_hz * lrf.beams;
  if (range_count > kRangeCountMax) {
    throw UsageError(
        fmt::format("the log would hold {:.1e} ranges; at most {:.0e} are written: take a lower --rate-hz, "
                    "fewer --beams or a shorter path",
                    range_count, kRangeCountMax));
  }
}

void run(const SimOptions& options) {
  const std::string truth = truth_file(options);
  if (truth == options.log || options.world == options.log || options.world == truth) {
    throw UsageError("the world, --out and --truth name the same file; expected three different ones");
  }
  const World world = read_world(options.world);
  check_size(world, options.lrf);
  const Simulation simulation = simulate(world, options.lrf, options.seed);
  write_whole_file(options.log, simulation.log);
  write_whole_file(truth, simulation.truth);
  fmt::print("{}: {} scans of {} beams, {:.1f} s, {:.1f} m\n", options.log, simulation.scans, options.lrf.beams,
             simulation.duration_s, simulation.length_m);
  fmt::print("{}: the true poses\n", truth);
}

std::vector<std::string> lrf_names() {
  std::vector<std::string> names;
  for (const LrfModel& model : lrf_models()) {
    names.emplace_back(model.name);
  }
  return names;
}

}  // namespace

void add_sim(CLI::App& app) {
  auto options = std::make_shared<SimOptions>();
  CLI::App* const command = app.add_subcommand("sim", "Simulate a laser on its way through a world");
  command->add_option("WORLD", options->world, "World file, such as tools/worlds/office.world")->required();
  command->add_option("--out", options->log, "CARMEN log to write: FLASER where the laser fits it, else ROBOTLASER1")
      ->required();
  command->add_option("--truth", options->truth, "True poses to write (TUM) [LOG with the extension .truth.tum]");
  command->add_option("--seed", options->seed, "Random seed of the noise: the same seed gives the same bytes")
      ->capture_default_str();
  // Before the parameters: options are applied in this order, and a parameter given by hand overrides the preset.
  command
      ->add_option_function<std::string>(
          "--lrf", [options](const std::string& name) { options->lrf = simulated_lrf_params(*find_lrf_model(name)); },
          "Laser whose data sheet gives the defaults below")
      ->check(CLI::IsMember(lrf_names()))
      ->default_str("lms200");
  ParameterOptions parameters(*command);
  SimulatedLrfParams::describe(options->lrf, parameters);
  command->footer("Statements of a world file (metres; # starts a comment):\n" + world_statements());
  command->callback([options] { run(*options); });
}

}  // namespace odoless
