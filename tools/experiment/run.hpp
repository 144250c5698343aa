#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "config/robot_params.hpp"
#include "core/cloud/mapping_params.hpp"
#include "core/grid/occupancy_map.hpp"
#include "tools/experiment/scene.hpp"
#include "tools/output/matches.hpp"
#include "tools/sim/tilted_simulation.hpp"

namespace odoless {

/// What a run in 3D has besides: of a simulated scene, how servo and robot move; of a recorded tilt log, how the servo
/// counts.
struct CloudSetting {
  TiltMotionParams tilt{};
  double speed_max_mps = 0.5;
  double servo_level_rad = 0.0;
  MappingParams mapping{};
};

/// One computation over the scans of a scene. Several experiments may look at the same one: its name says what it is.
struct Run {
  enum class Kind {
    kPairs,    ///< each scan with the one before
    kMapping,  ///< the whole pipeline with DP-SLAM
    kCloud,    ///< that of the level scans of a tilting laser, and a 3D map of all
  };

  std::string name{};  ///< also its folder's
  Scene scene{};
  Kind kind = Kind::kPairs;
  RobotParams params{};
  int every = 1;         ///< uses every N-th scan; not of kCloud
  CloudSetting cloud{};  ///< of kCloud alone
};

/// What a run of pairs or mapping left behind. All of it was read back from files, so that a resumed experiment sees
/// the same numbers.
struct RunOutput {
  std::vector<MatchRow> matches;
  std::vector<ReferencePose> trajectory;  ///< of mapping alone: one pose per scan used, as known at the end
  OccupancyMap map;                       ///< of mapping alone
};

/// Called with the share that is done, 0 to 1.
using ShareDone = std::function<void(double)>;

/// Estimated CPU time, for the order of work and the time left; no result depends on it.
[[nodiscard]] double estimate_cost_s(const Run& run);

/// All that the results depend on, the program included.
[[nodiscard]] std::string run_key(const Run& run, const Sources& sources);

/// Whether `folder` holds the finished run of that key.
[[nodiscard]] bool is_finished(const std::filesystem::path& folder, const std::string& key);
/// Notes that it does; to be called last.
void mark_finished(const std::filesystem::path& folder, const std::string& key);

/// Computes a run and writes matches.csv into `folder`, of mapping also trajectory.tum and the map; of a run in 3D what
/// cloud_output.hpp says.
void compute_run(const Run& run, const Sources& sources, const std::filesystem::path& folder, const ShareDone& done);

[[nodiscard]] RunOutput read_run(const Run& run, const std::filesystem::path& folder);

}  // namespace odoless
