#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "config/robot_params.hpp"
#include "firmware/world/world_contents.hpp"

namespace odoless {

/// What is to be written of a world.
struct WorldExport {
  std::filesystem::path out;  ///< folder
  bool force = false;         ///< in place of the results that are in the folder
  double resolution_m = 0.0;  ///< side of a map cell; 0: as configured
  /// Where north is in the world's frame, counter-clockwise from x: all is turned so that y is north. None: it is as it
  /// is.
  std::optional<double> north_deg;
  int session = 0;  ///< its map, with the sessions that loop closures join it with; 0: the last one that mapped
};

/// Writes map, trajectories and pose graph, with pictures; turns the world if that is asked for.
/// @param file  Its name in what is said.
/// @throws UsageError, DataError, CannotCreateError, IoError.
void export_world(StoredWorld& world, const std::filesystem::path& file, const WorldExport& asked);

/// Submaps that loop closures and odometry join with those of a session, in ascending order.
[[nodiscard]] std::vector<int> joined_submaps(const StoredWorld& world, const StoredSession& session);

/// What a session was run with; what this program does not know of it is said, and is then as built in.
[[nodiscard]] RobotParams params_of(const std::filesystem::path& file, const StoredSession& session);

}  // namespace odoless
