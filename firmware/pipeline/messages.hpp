#pragma once

#include <cstdint>

#include "core/motion/motion.hpp"
#include "firmware/records/health.hpp"
#include "rt/latency_histogram.hpp"

namespace odoless {

/// A scan's place in the pool; what goes through the queues instead of the scan itself.
using ScanSlot = std::uint32_t;
inline constexpr ScanSlot kNoSlot = UINT32_MAX;

/// From the matcher to the filter. The filter gives the slot back; a motion without a scan only composes.
struct MotionMessage {
  ScanSlot slot = kNoSlot;
  Motion motion;
  std::int64_t matcher_cpu_ns = 0;  ///< that it took to find it
};

/// What somebody outside asks of the filter.
struct FilterCommand {
  enum class Kind { kReset, kSetPose, kPause, kResume };
  Kind kind = Kind::kReset;
  Pose2 map_T_scan{};
};

/// What each stage says of itself after each piece of work; the publisher reads the newest.
struct StageReport {
  std::int64_t scans = 0;
  LatencyHistogram cpu;
  LongestRounds longest{};
  std::int64_t budget_ns = 0;
  std::int64_t deadline_misses = 0;
  std::int64_t page_faults = 0;
  std::int64_t allocations = -1;
};

/// How the tilt servo is.
struct TiltReport {
  bool used = false;
  bool obeys = true;           ///< it is there, without fault, and does what it was told
  bool level = true;           ///< the laser's plane is
  bool sweeps = false;         ///< as it was told
  std::int64_t refused = 0;    ///< its answers that were refused, and those that did not come
  std::int64_t held_back = 0;  ///< scans that were not given to 2D SLAM, for the laser was not level
};

/// CPU time per scan of the run.
struct CpuHistograms {
  LatencyHistogram sensor;
  LatencyHistogram matcher;
  LatencyHistogram filter;
  LatencyHistogram matcher_and_filter;
};

struct SensorReport {
  StageReport stage;
  SourceHealth source;
  TiltReport tilt;
  std::int64_t last_scan_ns = 0;  ///< host time at which the last good scan was complete; 0: none yet
  std::int64_t period_ns = 0;     ///< between scans, smoothed; 0: not known
  bool open = false;              ///< whether the device is
  bool blind = false;
  bool stuck = false;
};

struct MatcherReport {
  StageReport stage;
  double fitness = 0.0;
  double second_peak_ratio = 0.0;
  double strong_information_1_m2 = 0.0;
  double weak_information_1_m2 = 0.0;
  std::int32_t evaluations = 0;
  std::int32_t poor_in_a_row = 0;
  bool deadline_hit = false;
};

struct FilterReport {
  StageReport stage;
  LatencyHistogram with_matcher;  ///< CPU time per scan, of matcher and filter together
  double effective_particles = 0.0;
  std::int32_t particles = 0;
  double log_likelihood_per_beam = 0.0;
  double position_sd_m = 0.0;
  double yaw_sd_rad = 0.0;
  double pose_probability = 1.0;  ///< that the pose is right within 0.5 m and 5 deg
  double pool_used = 0.0;
  std::int64_t refused_tiles = 0;
  std::int64_t updates_cut = 0;  ///< ended by their deadline
  bool paused = false;
  bool doubtful = false;  ///< scans lately did not fit the map
  bool lost = false;      ///< and it is not known where the robot is in it
};

}  // namespace odoless
