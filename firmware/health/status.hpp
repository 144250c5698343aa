#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "firmware/records/health.hpp"
#include "firmware/records/records.hpp"
#include "firmware/world/world_report.hpp"

namespace odoless {

/// The known part of the map.
struct MapSize {
  double width_m = 0.0;
  double height_m = 0.0;
  double cell_size_m = 0.0;
};

/// The last save, or the one that is under way.
struct SaveStatus {
  enum class State { kNone, kSaving, kSaved, kFailed };
  State state = State::kNone;
  double since_s = 0.0;  ///< that it began, or ended
  std::string doing{};   ///< while it is under way
  std::string folder{};  ///< that it is in
  std::string wrong{};   ///< where it failed
};

/// All that a person asks of a daemon at a glance.
struct DaemonStatus {
  HealthReport health;
  std::optional<PoseRecord> pose{};  ///< the last one; none yet, or the filter runs elsewhere
  MapSize map{};
  double poses_hz = 0.0;  ///< published, over the last second
  SaveStatus save{};
  std::optional<WorldReport> world{};  ///< none: there is no world file
};

/// A few lines for a person: the state with its reasons first.
[[nodiscard]] std::string status_text(const DaemonStatus& status);

/// The same and more for programs; keys bear their units.
[[nodiscard]] nlohmann::ordered_json status_json(const DaemonStatus& status);

}  // namespace odoless
