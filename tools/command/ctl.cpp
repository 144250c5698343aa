#include "tools/command/ctl.hpp"

#include <fmt/core.h>
#include <sysexits.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

#include "config/config.hpp"
#include "drivers/io/device_advice.hpp"
#include "firmware/daemon/control_server.hpp"
#include "firmware/daemon/daemon_params.hpp"
#include "firmware/daemon/memory_budget.hpp"
#include "tools/command/control_socket.hpp"
#include "tools/command/error.hpp"

namespace odoless {
namespace {

DaemonParams load(const std::string& config) {
  DaemonParams params;
  if (!config.empty()) {
    load_parameters(config, params);
  }
  return params;
}

struct CtlArguments {
  std::string config;
  std::string socket;
  bool json = false;
  bool watch = false;
  bool force = false;
  std::vector<std::string> command;
};

/// The line that the daemon is sent.
std::string line_of(const CtlArguments& arguments) {
  std::string command;
  for (const std::string& word : arguments.command) {
    command += (command.empty() ? "" : " ") + word;
  }
  const bool is_save_to = arguments.command.front() == "save" && arguments.command.size() == 2;
  if (arguments.force && !is_save_to) {
    throw UsageError("--force goes with save PATH alone");
  }
  if (is_save_to) {  // the daemon has another working directory
    command = fmt::format("save {}{}", arguments.force ? "--force " : "",
                          std::filesystem::absolute(arguments.command.back()).lexically_normal().string());
  }
  if (command.size() > ControlServer::kCommandMaxBytes || command.find('\n') != std::string::npos) {
    throw UsageError(fmt::format("a command is one line of at most {} bytes", ControlServer::kCommandMaxBytes));
  }
  if ((arguments.json || arguments.watch) && command != "status" && command != "world") {
    throw UsageError("--json and --watch go with the commands status and world alone");
  }
  return command + (arguments.json ? " json" : "");
}

std::string advice_on(int error, const std::string& socket) {
  const std::string of_group = error == EACCES ? group_advice(socket) : "";
  return of_group.empty() ? "expected an odolessd that runs, and its socket (control.socket)" : of_group;
}

std::string ask(const std::string& socket, const std::string& command) {
  std::string answer;
  if (const int error = send_command(socket, command, answer); error != 0) {
    throw UserError(EX_UNAVAILABLE, fmt::format("{}: no daemon answers: {}; {}", socket, system_reason(error),
                                                advice_on(error, socket)));
  }
  if (answer.starts_with("error: ")) {
    throw UserError(EX_DATAERR, answer.substr(7, answer.find('\n') - 7));
  }
  return answer;
}

/// Waits until the save that was begun is done, and says where it is.
void follow_save(const std::string& socket) {
  const bool shows = ::isatty(STDERR_FILENO) == 1;
  nlohmann::json save;
  do {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    save = nlohmann::json::parse(ask(socket, "status json"))["save"];
    if (shows) {
      fmt::print(stderr, "\r{}\033[K", save["doing"].get<std::string>());
    }
  } while (save["state"] == "saving");
  if (shows) {
    fmt::print(stderr, "\r\033[K");
  }
  if (save["state"] != "saved") {
    throw CannotCreateError("not saved: " + save["error"].get<std::string>());
  }
  fmt::print("saved in {}\n", save["folder"].get<std::string>());
}

/// Waits until the daemon does with its world what it was told.
void follow_world(const std::string& socket, const std::string& mode) {
  nlohmann::json world;
  do {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    world = nlohmann::json::parse(ask(socket, "world json"));
  } while (world["going_over"].get<bool>() && world["error"].get<std::string>().empty());
  const std::string error = world["error"].get<std::string>();
  if (!error.empty()) {
    throw CannotCreateError("the world file cannot be written: " + error + "; it is tried again and again");
  }
  if (world["mode"] != mode) {
    throw UserError(EX_DATAERR, "mapping does not go on: " + world["refused"].get<std::string>());
  }
}

void run_ctl(const CtlArguments& arguments) {
  const std::string socket =
      arguments.socket.empty() ? socket_to_ask(load(arguments.config).control.socket) : arguments.socket;
  const std::string command = line_of(arguments);
  if (command.starts_with("save")) {
    static_cast<void>(ask(socket, command));
    return follow_save(socket);
  }
  if (command == "localise" || command == "map") {
    static_cast<void>(ask(socket, command));
    follow_world(socket, command == "map" ? "continue" : command);
    return fmt::print("{}", ask(socket, "world"));
  }
  const bool renews = arguments.watch && !arguments.json && ::isatty(STDOUT_FILENO) == 1;
  for (bool again = true; again; again = arguments.watch) {
    fmt::print("{}{}", renews ? "\033[H\033[J" : "", ask(socket, command));
    if (std::fflush(stdout) != 0) {
      throw IoError("standard output: writing failed");
    }
    std::this_thread::sleep_for(arguments.watch ? std::chrono::seconds(1) : std::chrono::seconds(0));
  }
}

void run_memory(const std::string& config) {
  const std::vector<MemoryShare> shares = memory_budget(load(config));
  constexpr double kMbPerByte = 1e-6;
  for (const MemoryShare& share : shares) {
    fmt::print("{:10.2f} MB  {}\n", static_cast<double>(share.bytes) * kMbPerByte, share.what);
  }
  fmt::print("{:10.2f} MB  in all\n", static_cast<double>(total_bytes(shares)) * kMbPerByte);
}

}  // namespace

void add_ctl(CLI::App& app) {
  const auto arguments = std::make_shared<CtlArguments>();
  CLI::App* const command = app.add_subcommand("ctl", "Ask or command the daemon that runs on this machine");
  command->add_option("--config", arguments->config, "The daemon's configuration, which names its socket");
  command->add_option("--socket", arguments->socket, "The socket itself");
  command->add_flag("--json", arguments->json, "With status and world: one JSON object, on one line");
  command->add_flag("--watch", arguments->watch, "With status and world: every second anew, until interrupted");
  command->add_flag("--force", arguments->force, "With save PATH: replace results that are there");
  command
      ->add_option("COMMAND", arguments->command,
                   "status, world, save [PATH], reset, pose X_M Y_M YAW_DEG, pause, resume, localise, map, "
                   "tilt level|sweep|stop, or stop; -- before negative numbers")
      ->required();
  command->callback([arguments] { run_ctl(*arguments); });
}

void add_memory(CLI::App& app) {
  const auto config = std::make_shared<std::string>();
  CLI::App* const command = app.add_subcommand("memory", "Memory that a daemon with a configuration locks, by purpose");
  command->add_option("CONFIG", *config, "TOML file of the robot; without it what is built in");
  command->callback([config] { run_memory(*config); });
}

}  // namespace odoless
