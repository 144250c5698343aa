#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/geometry/pose3.hpp"
#include "core/grid/occupancy_map.hpp"
#include "core/scan/laser_mount_params.hpp"
#include "firmware/daemon/daemon_params.hpp"
#include "firmware/daemon/stages.hpp"
#include "firmware/publisher/pose_stream.hpp"
#include "firmware/stages/scan_source.hpp"

namespace odoless {

/// What a run has made so far, or in the end.
struct DaemonResult {
  bool has_trajectory = false;   ///< poses are kept
  PoseStream trajectory;         ///< one per scan, as known now; of the scan frame, as all of SLAM
  PoseStream online_trajectory;  ///< as the robot had it at the time
  LaserPlace laser;              ///< on the robot
  OccupancyMap map;
  std::vector<Point3> cloud;  ///< the 3D map; empty where there is none, or it is not to be saved
  CloudFormat cloud_format = CloudFormat::kNone;
  HealthReport health;
  CpuHistograms cpu;
  double wall_s = 0.0;
};

/// What is to be saved, and where.
struct SaveRequest {
  std::filesystem::path folder{};  ///< empty: the run's own, in that of the options
  bool is_forced = false;          ///< results that are there already are replaced
  bool is_last = false;            ///< the run is over
};

/// What came of it.
struct SaveOutcome {
  std::string folder{};  ///< that it is in
  std::string wrong{};   ///< for a person; empty: nothing
  int error = 0;         ///< errno, where something is wrong
};

/// Told what is being done, e.g. "writing map.png": often enough to tell slow from stuck.
using SaveProgress = std::function<void(const std::string& doing)>;

struct DaemonOptions {
  DaemonParams params;
  StageSet stages = StageSet::kAll;
  std::uint64_t seed = 1;
  bool require_realtime = false;
  bool enforce_realtime = false;
  std::string version;           ///< of the program
  std::string configuration;     ///< all of it as TOML, for the world file
  std::filesystem::path folder;  ///< of the runs, each of which gets one in there; empty: none is saved at the end
  /// Instead of the laser, e.g. a recorded log; may be null.
  std::unique_ptr<ScanSource> source;
  /// Nothing is dropped, and no result depends on time: a log as fast as possible.
  bool lossless = false;
  /// Saves results, whole or not at all. Called by an ordinary thread, never by two at a time.
  std::function<SaveOutcome(const SaveRequest&, const std::function<DaemonResult()>&, const SaveProgress&)> save;
  /// Reads the configuration anew; returns what is wrong with it, or nothing.
  std::function<std::string(DaemonParams&)> reload;
};

/// Runs the daemon until a signal that would end a process (but those of a crash), the command `stop`, or the end of
/// its source; then drains the pipeline, saves and returns an exit status of sysexits.h: 0; 69 where the laser or the
/// socket for commands is in use by another program; 70 where a stage hung, after saving what was known; 71 where
/// threads, memory or descriptors do not suffice; 73 where results cannot be saved, or the socket cannot be made; 77
/// where something needed is not permitted; 78 where LCM's address makes no sense. What a start lacks is found out
/// before a device is touched, and logged with what would be right.
///
/// Locks the process's memory and blocks signals. To be called once, by the program's first thread while it is the only
/// one.
[[nodiscard]] int run_daemon(DaemonOptions options);

}  // namespace odoless
