#pragma once

#include <cstdint>
#include <vector>

#include "config/robot_params.hpp"
#include "core/cloud/cloud_mapper.hpp"
#include "core/cloud/mapping_params.hpp"
#include "tools/log/tilt_log.hpp"
#include "tools/replay/replay.hpp"

namespace odoless {

/// How the servo's angles become tilt angles at the scans' times.
struct ServoParams {
  double level_rad = 0.0;           ///< the servo's own angle at the level pose
  bool inverted = false;            ///< its angle grows upwards
  std::int64_t clock_ahead_ns = 0;  ///< how far its clock is ahead of the scans'
};

/// All that a cloud is made with, besides the log.
struct CloudSetup {
  ServoParams servo{};
  MappingParams mapping{};
  RobotParams robot{};
  std::uint64_t seed = 1;
};

/// What a tilt log was made into.
struct CloudRun {
  CloudMapper mapper;
  ReplayResult slam{};  ///< of the level scans
  int level_scans = 0;
  int scans_in_cloud = 0;
  int scans_without_pose = 0;
  double cloud_cpu_s = 0.0;  ///< of projection and thinning alone
};

/// Poses from the level scans by 2D SLAM; a cloud from all scans, each beam at its own angle and time; its keys
/// then put where the final trajectory has them.
///
/// @throws UserError (65) where too few scans are level, or one has too many beams.
[[nodiscard]] CloudRun make_cloud(const TiltLog& log, const CloudSetup& setup, const ReplayProgress& progress);

/// What the servo's clock is ahead by, as the cloud itself says: with the right angles surfaces are thin, and the
/// returns fill the fewest voxels.
struct ClockEstimate {
  std::int64_t clock_ahead_ns = 0;
  double voxels_per_return = 0.0;         ///< at that
  double voxels_per_return_before = 0.0;  ///< at what `setup.servo` says
  /// False: no offset makes the surfaces clearly thinner, or the best lies at the end of the search; what `setup.servo`
  /// says stands.
  bool is_told = false;
};

/// Searches +-0.4 s around what `setup.servo` says, to 2 ms, with the poses of a run that was made with that.
[[nodiscard]] ClockEstimate align_clocks(const TiltLog& log, const CloudSetup& setup, const ReplayResult& slam);

}  // namespace odoless
