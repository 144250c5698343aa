#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "config/robot_params.hpp"
#include "firmware/world/world_contents.hpp"
#include "tools/eval/report.hpp"
#include "tools/eval/stamp_lookup.hpp"
#include "tools/log/scan_log.hpp"

namespace odoless {

/// A recorded drive, and where the robot was in the world's frame; scans of which nobody knows it are not judged.
struct KnownDrive {
  const ScanLog& log;
  const StampLookup& truth;
};

struct PlacesParams {
  int places = 200;
  std::uint64_t seed = 1;
  double in_time_s = 10.0;  ///< of scans, within which the robot is to be found
  double watched_s = 30.0;  ///< of scans, that a robot is watched
  double tolerance_s = 0.01;
};

/// One place of the log, from which on the robot was looked for.
struct TriedPlace {
  static constexpr double kSeen_m = 2.0;

  double stamp_s = 0.0;
  bool is_seen = false;            ///< the world has a scan from within kSeen_m: in a part that it knows
  double told_after_s = -1.0;      ///< until the first right pose, a guess (DEGRADED) or OK; negative: none
  double sure_after_s = -1.0;      ///< until the state is OK; negative: never
  int guessed_scans = 0;           ///< with a pose, but not OK
  int wrong_guesses = 0;           ///< of these, off by more than OK promises
  int wrong_scans = 0;             ///< with the state OK, and off by more than that
  std::vector<double> errors_m{};  ///< of poses with the state OK
};

/// Puts a robot at random places of a log, one after the other, into a world that stays as it is and that says nothing
/// of where it begins, and watches when it is found, and whether it is there.
///
/// @throws UsageError  where the pools of the configuration have no room for the world.
[[nodiscard]] std::vector<TriedPlace> try_places(const KnownDrive& drive, const StoredWorld& world,
                                                 const RobotParams& params, const PlacesParams& wanted,
                                                 const std::function<void(int done)>& progress);

/// How many were found, in time, and right; of all, and of those that the world has seen.
[[nodiscard]] Report report(const std::vector<TriedPlace>& tried, const PlacesParams& wanted);

}  // namespace odoless
