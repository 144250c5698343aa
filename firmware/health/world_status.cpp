#include "firmware/health/world_status.hpp"

#include <fmt/format.h>

#include <array>
#include <cstddef>
#include <nlohmann/json.hpp>

namespace odoless {
namespace {

constexpr std::array<const char*, 3> kPlaceNames{"unknown", "guessed", "sure"};
constexpr std::array<const char*, 2> kModeTexts{"the map grows and is corrected",
                                                "the map stays as it is, and the robot finds its way in it"};

std::size_t mode_of(const WorldStatus& status) { return status.use() == WorldUse::kLocalise ? 1 : 0; }

std::string file_text(const WorldStatus& status) {
  return status.file
             ? fmt::format("world: {}, {}, revision {}", status.file->file, status.file->uuid, status.file->revision)
             : "world: in memory alone, without a file (--world, world.file)";
}

std::string written_text(const WorldStatus& status) {
  if (!status.file) {
    return "";
  }
  const WorldReport& file = *status.file;
  const std::string refused = file.refused.empty() ? "" : fmt::format("mapping does not go on: {}\n", file.refused);
  return (file.error != 0     ? fmt::format("cannot be written for {:.0f} s: {}\n", file.age_s, file.reason)
          : file.is_read_only ? "closed: all is written\n"
                              : fmt::format("written {:.1f} s ago\n", file.age_s)) +
         refused;
}

}  // namespace

WorldUse WorldStatus::use() const {
  return (file ? file->is_read_only : graph.is_localising) ? WorldUse::kLocalise : WorldUse::kContinue;
}

bool WorldStatus::is_going_over() const { return graph.is_going_over || (file && file->is_going_over); }

std::string world_status_text(const WorldStatus& status) {
  const GraphHealth& graph = status.graph;
  return fmt::format(
      "{}\nmode: {}: {}{}\nplace of the robot: {}\nmap: {} submaps, {} keyframes, {:.0f} % of its room\n{}",
      file_text(status), kWorldUseNames[mode_of(status)], kModeTexts.at(mode_of(status)),
      status.is_going_over() ? "; going over to the other" : "", kPlaceNames.at(static_cast<std::size_t>(graph.place)),
      graph.submaps, graph.keyframes, 100.0 * graph.used, written_text(status));
}

nlohmann::ordered_json world_status_json(const WorldStatus& status) {
  const GraphHealth& graph = status.graph;
  const WorldReport file = status.file.value_or(WorldReport{});
  return {{"file", file.file},
          {"uuid", file.uuid},
          {"revision", file.revision},
          {"mode", kWorldUseNames[mode_of(status)]},
          {"going_over", status.is_going_over()},
          {"place", kPlaceNames.at(static_cast<std::size_t>(graph.place))},
          {"submaps", graph.submaps},
          {"keyframes", graph.keyframes},
          {"room_used", graph.used},
          {"age_s", file.age_s},
          {"error", file.reason},
          {"refused", file.refused}};
}

}  // namespace odoless
