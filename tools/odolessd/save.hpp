#pragma once

#include <functional>

#include "firmware/daemon/daemon.hpp"
#include "tools/odolessd/run_folder.hpp"

namespace odoless {

/// Writes trajectory.tum, trajectory_online.tum, map.pgm, map.yaml, map.png, summary.json and, of a daemon that maps in
/// 3D, cloud.ply or cloud.pcd: all of them or none. The trajectories take no memory, however long they are.
[[nodiscard]] SaveOutcome save_result(RunFolder& run, const SaveRequest& request,
                                      const std::function<DaemonResult()>& result_now, const SaveProgress& tell);

}  // namespace odoless
