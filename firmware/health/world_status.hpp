#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "firmware/records/health.hpp"
#include "firmware/world/world_params.hpp"
#include "firmware/world/world_report.hpp"

namespace odoless {

/// The world of a daemon: the map in its memory, and the file that keeps it.
struct WorldStatus {
  GraphHealth graph;
  std::optional<WorldReport> file{};  ///< none: it is in memory alone

  [[nodiscard]] WorldUse use() const;
  /// Whether it is about to do the other.
  [[nodiscard]] bool is_going_over() const;
};

/// A few lines for a person.
[[nodiscard]] std::string world_status_text(const WorldStatus& status);

/// The same for programs; keys bear their units.
[[nodiscard]] nlohmann::ordered_json world_status_json(const WorldStatus& status);

}  // namespace odoless
