#include "tools/command/command_line.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <exception>
#include <new>
#include <span>
#include <string>
#include <system_error>
#include <vector>

#include "config/config_error.hpp"
#include "config/misspelling.hpp"
#include "tools/command/calibrate.hpp"
#include "tools/command/campaign.hpp"
#include "tools/command/cloud.hpp"
#include "tools/command/completion.hpp"
#include "tools/command/config.hpp"
#include "tools/command/ctl.hpp"
#include "tools/command/empty_values.hpp"
#include "tools/command/emulate.hpp"
#include "tools/command/error.hpp"
#include "tools/command/eval.hpp"
#include "tools/command/experiment.hpp"
#include "tools/command/graph.hpp"
#include "tools/command/info.hpp"
#include "tools/command/manual.hpp"
#include "tools/command/probe.hpp"
#include "tools/command/replay.hpp"
#include "tools/command/sim.hpp"
#include "tools/command/world.hpp"

namespace odoless {
namespace {

constexpr int kUsage = 64;
constexpr int kSoftware = 70;
constexpr int kSystem = 71;
constexpr int kInputOutput = 74;
constexpr int kConfiguration = 78;

/// Every sub-command, in the order of --help. A new one: its own tools/command/NAME.hpp and .cpp, and a line here.
void add_commands(CLI::App& app) {
  add_replay(app);
  add_match(app);
  add_cloud(app);
  add_info(app);
  add_calibrate(app);
  add_eval(app);
  add_graph(app);
  add_world(app);
  add_sim(app);
  add_experiment(app);
  add_campaign(app);
  add_emulate(app);
  add_probe(app);
  add_ctl(app);
  add_memory(app);
  add_config(app);
  add_manual(app);
  add_completion(app);
}

int fail(int exit_code, const char* what, const char* reason) {
  static_cast<void>(std::fprintf(stderr, "odoless: %s%s\n", what, reason));
  return exit_code;
}

void flush_output() {
  if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) {
    throw IoError("standard output: writing failed");
  }
}

std::vector<std::string> commands_of(CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* const command : app.get_subcommands([](const CLI::App*) { return true; })) {
    names.push_back(command->get_name());
  }
  return names;
}

/// A word where a command must stand, and is none: CLI11 would only say that one is required.
void refuse_misspelled_command(CLI::App& app, std::span<const char* const> words) {
  const std::vector<std::string> names = commands_of(app);
  if (words.empty() || app.get_require_subcommand_min() == 0 || words.front()[0] == '-') {
    return;
  }
  const std::string word = words.front();
  if (std::find(names.begin(), names.end(), word) != names.end()) {
    return refuse_misspelled_command(*app.get_subcommand(word), words.subspan(1));
  }
  const std::string meant = nearest_name(word, names);
  throw UsageError(meant.empty() ? fmt::format("'{}' is no command; there are {}", word, fmt::join(names, ", "))
                                 : fmt::format("'{}' is no command; did you mean {}?", word, meant));
}

int parse_and_run(CLI::App& app, int argc, const char* const* argv) {
  refuse_misspelled_command(app, std::span(argv, static_cast<std::size_t>(argc)).subspan(1));
  try {
    app.parse(argc, argv);
    return 0;
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : kUsage;  // prints the help, the version, or what is wrong with the arguments
  }
}

}  // namespace

int run_command_line(int argc, const char* const* argv) {
  try {
    CLI::App app("SLAM for robots without odometry: one laser range finder, nothing else", "odoless");
    app.set_version_flag("--version", "odoless " ODOLESS_VERSION);
    app.require_subcommand(1);
    app.set_help_all_flag("--help-all", "Print the help of every sub-command");
    app.failure_message(CLI::FailureMessage::simple);
    add_commands(app);
    refuse_empty_values(app);
    const int status = parse_and_run(app, argc, argv);
    flush_output();
    return status;
  } catch (const UserError& error) {
    return fail(error.exit_code(), "", error.what());
  } catch (const ConfigError& error) {
    return fail(kConfiguration, "", error.what());
  } catch (const std::system_error& error) {
    return fail(kInputOutput, "", error.what());
  } catch (const std::bad_alloc&) {
    return fail(kSystem, "", "out of memory");
  } catch (const std::exception& error) {
    return fail(kSoftware, "internal error: ", error.what());
  }
}

}  // namespace odoless
