#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "config/robot_params.hpp"
#include "core/grid/occupancy_map.hpp"
#include "tools/experiment/scene.hpp"
#include "tools/output/matches.hpp"

namespace odoless {

/// One computation over the scans of a scene. Several experiments may look at the same one: its name says what it is.
struct Run {
  enum class Kind { kPairs, kMapping };  ///< each scan with the one before; or the whole pipeline with DP-SLAM

  std::string name{};  ///< also its folder's
  Scene scene{};
  Kind kind = Kind::kPairs;
  RobotParams params{};
  int every = 1;  ///< uses every N-th scan
};

/// What a run left behind. All of it was read back from files, so that a resumed experiment sees the same numbers.
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

/// Computes a run and writes matches.csv into `folder`, of mapping also trajectory.tum and the map.
void compute_run(const Run& run, const Sources& sources, const std::filesystem::path& folder, const ShareDone& done);

[[nodiscard]] RunOutput read_run(const Run& run, const std::filesystem::path& folder);

}  // namespace odoless
