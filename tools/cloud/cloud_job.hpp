#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "firmware/daemon/daemon_params.hpp"
#include "tools/cloud/cloud_check.hpp"
#include "tools/cloud/cloud_run.hpp"
#include "tools/replay/verdict.hpp"
#include "tools/sim/tilted_simulation.hpp"

namespace odoless {

/// What a 3D map is to be made of, and how.
struct CloudJob {
  std::string input;  ///< a tilt log, or a world file with the extension .world
  std::filesystem::path out;
  DaemonParams params;
  ServoParams servo;
  std::optional<double> clock_ahead_s;  ///< none: it is estimated
  SimulatedLrfParams lrf{};
  TiltMotionParams tilt{};
  double speed_max_mps = std::numeric_limits<double>::infinity();  ///< of the simulated robot: no faster than that
  std::optional<TiltMountParams> true_mount;                       ///< of the simulated laser; none: as configured
  std::int64_t scans_max = 0;                                      ///< the first so many; 0: all
  std::uint64_t seed = 1;
  int keys_shown = 0;
  bool write_log = false;
};

/// How far a cloud is from the truth: from every point of the map to the nearest surface of the simulated building,
/// after the motion of the whole trajectory that fits it best to the true one.
struct CloudTruth {
  std::vector<double> distances_m{};  ///< of CloudResult::points, one each
  Statistics distance_m{};
  Statistics pose_error_m{};
};

struct CloudResult {
  CloudRun run;
  std::vector<Point3> points{};  ///< merged, in the map
  CloudCheck check{};
  ClockEstimate clock{};
  bool clock_is_estimated = false;
  std::optional<CloudTruth> truth{};
  std::vector<std::string> corrected{};  ///< in the log, for its numbers to be a laser's
  RunFigures figures{};                  ///< of the level scans
  Verdict verdict{};
};

/// Reads or simulates, aligns the clocks, maps. Writes nothing. @throws UserError, also where nothing is seen.
[[nodiscard]] CloudResult run_cloud_job(const CloudJob& job, const ReplayProgress& progress);

/// Where the points of the first so many key poses lie in the map.
[[nodiscard]] std::vector<Point3> points_of_keys(const KeyedCloud& cloud, std::size_t keys);

/// Writes cloud.ply, cloud.pcd, cloud_top.png, cloud_perspective.png, trajectory.tum and summary.json into `job.out`;
/// with `keys_shown`, cloud_keys.png of the first so many keys. @throws UserError.
void write_cloud_result(const CloudJob& job, const CloudResult& result);

}  // namespace odoless
