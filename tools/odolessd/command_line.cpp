#include "tools/odolessd/command_line.hpp"

#include <fmt/core.h>
#include <sysexits.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <memory>
#include <new>
#include <string>
#include <vector>

#include "config/config.hpp"
#include "firmware/daemon/daemon.hpp"
#include "firmware/daemon/start_up.hpp"
#include "rt/clock.hpp"
#include "tools/command/control_socket.hpp"
#include "tools/command/empty_values.hpp"
#include "tools/command/error.hpp"
#include "tools/log/plausibility.hpp"
#include "tools/odolessd/replay_source.hpp"
#include "tools/odolessd/save.hpp"
#include "tools/output/whole_file.hpp"
#include "tools/probe/connected.hpp"

namespace odoless {
namespace {

constexpr const char* kName = "odolessd";
constexpr const char* kPurpose = "SLAM for robots without odometry: the daemon";

struct Arguments {
  std::string config;
  std::string out;
  std::string world;
  bool localise = false;
  std::string stages = "sensor,matcher,filter";
  std::string replay;
  double rate = 0.0;
  std::string topic;
  double period_ms = 200.0;
  std::uint64_t seed = 1;
  bool check = false;
  bool require_realtime = false;
  bool enforce_realtime = false;
};

void define(CLI::App& app, Arguments& arguments) {
  app.set_version_flag("--version", "odolessd " ODOLESS_VERSION);
  app.failure_message(CLI::FailureMessage::simple);
  app.add_option("--config", arguments.config, "TOML file of the robot (see `odoless config defaults`)");
  app.add_flag("--check", arguments.check, "Check the configuration, print what is wrong with it, and exit");
  app.add_option(
      "--out", arguments.out,
      "Folder of runs: map, trajectories and summary of this one go into a new folder in there, at the end and on "
      "`odoless ctl save`; `latest` leads to it");
  app.add_option("--world", arguments.world,
                 "World file that keyframes, submaps and the pose graph are kept in; made where it is not there");
  app.add_flag("--localise", arguments.localise, "Leave the world of --world as it is, and only find the way in it");
  app.add_option("--stages", arguments.stages,
                 "Stages that run here; the others run elsewhere: " + std::string(kStageSets))
      ->capture_default_str();
  app.add_option("--replay", arguments.replay, "A recorded log instead of the laser; ends with it");
  app.add_option("--rate", arguments.rate,
                 "Recorded seconds per second; 0: as fast as possible, and nothing is dropped")
      ->check(CLI::Range(0.0, 1000.0))
      ->capture_default_str();
  app.add_option("--topic", arguments.topic, "Topic of the scans, where the log of --replay has several");
  app.add_option("--period-ms", arguments.period_ms, "Time between scans of a log without stamps")
      ->check(CLI::Range(0.001, 1e6))
      ->capture_default_str();
  app.add_option("--seed", arguments.seed, "Random seed")->capture_default_str();
  app.add_flag(
      "--require-realtime", arguments.require_realtime,
      "End with status 77 where real-time scheduling or locked memory is refused, 78 where a stage has no priority");
  app.add_flag("--enforce-realtime", arguments.enforce_realtime,
               "Kill the daemon when a real-time thread makes a system call that is not on its list, or uses the heap");
}

StageSet stages_of(const std::string& text) {
  const std::optional<StageSet> stages = parse_stages(text);
  if (!stages) {
    throw UsageError(fmt::format("--stages {}: must be {}", text, kStageSets));
  }
  return *stages;
}

void load(const std::string& config, DaemonParams& params) {
  load_parameters(config, params);
  if (const std::string wrong = params.contradiction(); !wrong.empty()) {
    throw ConfigError({config + ": " + wrong});
  }
}

DaemonOptions options_of(const Arguments& arguments) {
  DaemonOptions options;
  if (!arguments.config.empty()) {
    load(arguments.config, options.params);
  }
  if (!arguments.world.empty()) {
    options.params.world.file = arguments.world;
  }
  if (arguments.localise) {
    options.params.world.mode = WorldUse::kLocalise;
  }
  if (const std::string wrong = options.params.contradiction(); !wrong.empty()) {
    throw ConfigError({wrong});
  }
  options.version = ODOLESS_VERSION;
  options.configuration = write_toml(options.params);
  options.params.control.socket = socket_to_open(options.params.control.socket);
  options.stages = stages_of(arguments.stages);
  if (!arguments.world.empty() && !has_filter(options.stages)) {
    throw UsageError("--world needs the filter stage here, which has the map");
  }
  options.seed = arguments.seed;
  options.require_realtime = arguments.require_realtime;
  options.enforce_realtime = arguments.enforce_realtime;
  if (const std::string lack = lack_of_priority(options); !lack.empty()) {
    throw ConfigError({lack});
  }
  options.folder = arguments.out;
  options.save = [run = std::make_shared<RunFolder>(options.folder)](const auto& request, const auto& result,
                                                                     const auto& tell) {
    return save_result(*run, request, result, tell);
  };
  options.reload = [config = arguments.config](DaemonParams& params) -> std::string {
    try {
      params = {};
      load(config, params);
      return "";
    } catch (const std::exception& error) {
      return error.what();
    }
  };
  return options;
}

void add_replay(const Arguments& arguments, DaemonOptions& options) {
  if (!has_matcher(options.stages)) {
    throw UsageError("--replay needs the sensor and matcher stages here");
  }
  std::vector<std::string> corrected;
  ScanLog log = read_plausible_log(
      arguments.replay,
      {.default_period_ns = static_cast<std::int64_t>(arguments.period_ms * 1e6), .topic = arguments.topic}, corrected);
  for (const std::string& correction : corrected) {
    fmt::print(stderr, "odolessd: {}: {}\n", arguments.replay, correction);
  }
  constexpr std::int64_t kHead_ns = 200'000'000;  // for the threads to be there
  options.source = std::make_unique<ReplaySource>(std::move(log), arguments.rate, MonotonicClock().now_ns() + kHead_ns);
  options.lossless = arguments.rate <= 0.0;
}

/// A daemon that was told nothing may be somebody's first try: says what it does, what is connected, and how to go on.
void advise_beginner(const DaemonOptions& options) {
  if (const std::string& socket = options.params.control.socket; socket != ControlParams{}.socket) {
    fmt::print(stderr, "odolessd: `odoless ctl` finds this user's daemon at {}\n", socket);
  }
  const std::string& device = options.params.lrf.device;
  fmt::print(stderr, "odolessd: no configuration (--config ROBOT.toml): as built in, a Hokuyo laser on {}\n", device);
  const std::vector<SerialDevice> connected = connected_serial_devices();
  for (const SerialDevice& line : connected) {
    fmt::print(stderr, "odolessd: connected: {}{}\n", line.stable_path, line.name.empty() ? "" : ", " + line.name);
  }
  fmt::print(stderr,
             "odolessd: {}`odoless probe` asks lasers and prints the configuration for them; `odoless emulate lrf "
             "--pty PATH` is one to try with\n",
             connected.empty() ? "no serial line is connected; " : "");
}

int run(const Arguments& arguments) {
  DaemonOptions options = options_of(arguments);
  if (arguments.check) {
    fmt::print("{}: valid\n", arguments.config.empty() ? "built-in configuration" : arguments.config);
    return EX_OK;
  }
  if (!arguments.out.empty()) {
    make_output_folder(arguments.out);
  }
  if (!arguments.replay.empty()) {
    add_replay(arguments, options);
  } else if (arguments.config.empty() && has_matcher(options.stages)) {
    advise_beginner(options);
  }
  return run_daemon(std::move(options));
}

std::string out_of_memory_text() {
  return "memory does not suffice for this configuration: `odoless memory ROBOT.toml` tells what it needs" +
         memory_limits_text();
}

int fail(int status, const char* what, const char* reason) {
  static_cast<void>(std::fprintf(stderr, "odolessd: %s%s\n", what, reason));
  return status;
}

}  // namespace

void describe_odolessd(const std::function<void(const CLI::App&)>& reader) {
  CLI::App app(kPurpose, kName);
  Arguments arguments;
  define(app, arguments);
  reader(app);
}

int run_odolessd(int argc, const char* const* argv) {
  CLI::App app(kPurpose, kName);
  Arguments arguments;
  define(app, arguments);
  refuse_empty_values(app);
  try {
    app.parse(argc, argv);
    return run(arguments);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? EX_OK : EX_USAGE;
  } catch (const UserError& error) {
    return fail(error.exit_code(), "", error.what());
  } catch (const ConfigError& error) {
    return fail(EX_CONFIG, "", error.what());
  } catch (const std::bad_alloc&) {
    return fail(EX_OSERR, "", out_of_memory_text().c_str());
  } catch (const std::exception& error) {
    return fail(EX_SOFTWARE, "internal error: ", error.what());
  }
}

}  // namespace odoless
