#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "config/robot_params.hpp"
#include "core/geometry/stamped_pose.hpp"
#include "core/graph/pose_graph.hpp"
#include "core/graph/submap_graph.hpp"
#include "core/grid/occupancy_map.hpp"
#include "firmware/records/health.hpp"
#include "firmware/stages/stage_chain.hpp"
#include "firmware/world/world_contents.hpp"
#include "tools/log/scan_log.hpp"
#include "tools/output/matches.hpp"

namespace odoless {

/// Called at the end with the pose graph, where it is on, and odom_T_scan of all scans used.
using GraphWatcher = std::function<void(const SubmapGraph&, std::span<const StampedPose>)>;

/// Which scans of a log are used, and the generator's seed.
struct ReplayOptions {
  int every = 1;
  std::uint64_t seed = 1;
  GraphWatcher on_graph{};             ///< may be empty
  const StoredWorld* world = nullptr;  ///< that the pose graph goes on with; null: none
  WorldUse world_use = WorldUse::kContinue;
};

/// Called after each scan that was accepted, with what the stages made of it; may be empty.
using ReplayWatcher = std::function<void(const ChainStep&, const RawScan&, StageChain&)>;

/// Called after each scan: scans done, scans in all, fitness of the last match.
using ReplayProgress = std::function<void(std::int64_t, std::int64_t, double)>;

/// What a log was made into.
struct ReplayResult {
  std::vector<StampedPose> trajectory;         ///< final: one pose per scan used, by the pose graph where it is on
  std::vector<StampedPose> online_trajectory;  ///< the filter's estimates at the time
  std::optional<PoseGraph> graph;              ///< where it is on
  SubmapGraph::Counts closures{};
  std::vector<MatchRow> matches;
  OccupancyMap map;
  int poor_matches = 0;  ///< not converged
  int retried_matches = 0;
  int ambiguous_matches = 0;  ///< with another answer that is at least a tenth as likely
  int outside_scans = 0;      ///< whose beams reach beyond the grid
  double missing_s = 0.0;     ///< in gaps of more than a second between two scans
  int filter_updates = 0;
  int unlocated_scans = 0;                       ///< taken while nothing was known of where in the world
  int guessed_scans = 0;                         ///< taken while that was a guess
  int lost_scans = 0;                            ///< taken while the robot was lost
  int doubtful_scans = 0;                        ///< whose pose was not sure, nor lost
  int ok_but_off_scans = 0;                      ///< whose pose was sure, but not where the final path has it
  int drifted_scans = 0;                         ///< whose pose was sure but for what the map may have drifted
  int relocalisations = 0;                       ///< times that it was found again
  double least_fit = 1.0;                        ///< worst fit of a scan to the map while it was not lost
  std::vector<double> scan_cpu_us;               ///< of matcher and filter, one per scan used
  std::vector<std::int64_t> rss_bytes_by_tenth;  ///< of the process, after each tenth of the scans
  double log_duration_s = 0.0;
  SourceHealth source{};  ///< what the sensor stage took and refused, and what the stamps were like
};

/// Runs a log through the stages of the daemon on one thread. The same log, parameters and options give the same
/// result, but for times and memory. The memory of each scan's ranges is given back when it has been used: a long log
/// and the map of it are never whole in memory at once.
[[nodiscard]] ReplayResult replay(ScanLog log, const RobotParams& params, const ReplayOptions& options,
                                  const ReplayProgress& progress, const ReplayWatcher& watcher = {});

/// Matches each scan used with the one before: no filter, no local map, no expectation.
[[nodiscard]] std::vector<MatchRow> match_pairs(const ScanLog& log, const RobotParams& params,
                                                const ReplayOptions& options, const ReplayProgress& progress);

}  // namespace odoless
