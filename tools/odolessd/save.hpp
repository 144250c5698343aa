#pragma once

#include <filesystem>
#include <string>

#include "firmware/daemon/daemon.hpp"

namespace odoless {

/// Writes trajectory.tum, trajectory_online.tum, map.pgm, map.yaml, map.png, summary.json and, of a daemon that maps in
/// 3D, cloud.ply or cloud.pcd, each whole or not at all.
/// @return  What went wrong, for a person, or nothing.
[[nodiscard]] std::string save_result(const std::filesystem::path& folder, const DaemonResult& result);

}  // namespace odoless
