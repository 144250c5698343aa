#include "firmware/daemon/commands.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <optional>

#include "firmware/health/world_status.hpp"

namespace odoless {
namespace {

constexpr const char* kNoGraph = "error: there is no world: the pose graph is off (graph.enabled), or runs elsewhere\n";

FilterCommand filter_command_of(const ControlCommand& command, const LaserPlace& laser, const Publisher& publisher) {
  using Kind = FilterCommand::Kind;
  if (command.kind == ControlCommand::Kind::kPose) {
    return {Kind::kSetPose, publisher.to_local(laser.scan_of(command.map_T_robot))};
  }
  return {command.kind == ControlCommand::Kind::kPause    ? Kind::kPause
          : command.kind == ControlCommand::Kind::kResume ? Kind::kResume
                                                          : Kind::kReset};
}

}  // namespace

Commands::Commands(const DaemonOptions& options, Machine& machine, Saver& saver, bool& ending)
    : options_(options), machine_(machine), saver_(saver), ending_(ending) {}

std::string Commands::obey(const ControlCommand& command) {
  switch (command.kind) {
    case ControlCommand::Kind::kStatus:
      return status_text(status());
    case ControlCommand::Kind::kStatusJson:
      return status_json(status()).dump() + "\n";
    case ControlCommand::Kind::kWorld:
    case ControlCommand::Kind::kWorldJson:
      return tell_of_world(command.kind == ControlCommand::Kind::kWorldJson);
    case ControlCommand::Kind::kLocalise:
      return go_over(WorldUse::kLocalise);
    case ControlCommand::Kind::kMap:
      return go_over(WorldUse::kContinue);
    case ControlCommand::Kind::kSave:
      return begin_save(command);
    case ControlCommand::Kind::kStop:
      ending_ = true;
      return "ok\n";
    case ControlCommand::Kind::kTilt:
      return command_tilt(command.tilt);
    default:
      return command_filter(command);
  }
}

std::string Commands::command_tilt(TiltCommand command) {
  if (machine_.tilt() == nullptr) {
    return "error: there is no tilt servo (tilt.driver)\n";
  }
  machine_.tilt()->request(command);
  machine_.pipeline().sensor.wake.notify();
  return "ok\n";
}

std::string Commands::command_filter(const ControlCommand& command) {
  if (!has_filter(options_.stages)) {
    return "error: the filter runs elsewhere\n";
  }
  const LaserPlace laser = LaserPlace::of(options_.params.robot.mount);
  if (command.kind == ControlCommand::Kind::kPose && machine_.publisher().expect(laser.scan_of(command.map_T_robot))) {
    return "ok: the robot is looked for there\n";
  }
  if (!machine_.pipeline().commands.try_push(filter_command_of(command, laser, machine_.publisher()))) {
    return "error: too many commands wait\n";
  }
  machine_.pipeline().filter.wake.notify();
  return "ok\n";
}

DaemonStatus Commands::status() const {
  DaemonStatus status = machine_.publisher().status();
  status.save = saver_.status();
  return status;
}

std::string Commands::tell_of_world(bool as_json) const {
  const std::optional<WorldStatus> world = machine_.publisher().world_status();
  if (!world) {
    return kNoGraph;
  }
  return as_json ? world_status_json(*world).dump() + "\n" : world_status_text(*world);
}

std::string Commands::go_over(WorldUse use) {
  const std::optional<WorldStatus> world = machine_.publisher().world_status();
  if (!world) {
    return kNoGraph;
  }
  if (world->is_going_over()) {
    return "error: it is going over to the other: ask again when it has, as world says\n";
  }
  if (world->use() == use) {
    return fmt::format("ok: that is what it does ({})\n", kWorldUseNames[static_cast<int>(use)]);
  }
  if (use == WorldUse::kLocalise && world->graph.keyframes == 0) {
    return "error: there is no map yet\n";
  }
  if (use == WorldUse::kContinue && world->graph.used >= 1.0) {
    return "error: the map is full: raise graph.submaps_max, constraints_max and keyframes_max, and start anew\n";
  }
  machine_.publisher().go_over(use);
  return "ok: going over; world says when it has\n";
}

std::string Commands::begin_save(const ControlCommand& command) {
  if (ending_) {
    return "error: the daemon ends, and saves by itself\n";
  }
  if (command.folder.empty() && options_.folder.empty()) {
    return "error: there is no folder for results (odolessd --out): name one (save /PATH)\n";
  }
  if (!saver_.begin({.folder = command.folder, .is_forced = command.is_forced})) {
    return fmt::format("error: a save is under way ({}): ask again when it is done, as status says\n",
                       saver_.status().doing);
  }
  return "ok: saving; status says when it is done\n";
}

}  // namespace odoless
