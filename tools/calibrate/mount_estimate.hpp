#pragma once

#include <optional>
#include <span>
#include <vector>

#include "config/robot_params.hpp"
#include "tools/log/reference_poses.hpp"
#include "tools/log/scan_log.hpp"
#include "tools/output/matches.hpp"

namespace odoless {

/// Whether the laser's left is the robot's left, by the turns that scan matching sees and those that somebody else
/// tells. Scans alone cannot tell: a mirrored scan is as good a scan of the mirrored building.
struct Handedness {
  enum class Verdict { kUnknown, kRight, kSwapped };

  Verdict verdict = Verdict::kUnknown;
  double turned_rad = 0.0;          ///< sum of the turns that were compared, whichever way
  double agreement = 0.0;           ///< 1: scans turn as was told; -1: the other way; of turns weighed by themselves
  std::vector<MatchRow> matches{};  ///< of the scans as they are listed
};

/// By the poses of each scan that the log itself, or another file, tells: wheel odometry or anything else.
[[nodiscard]] Handedness compare_turns(std::vector<MatchRow> matches, const ReferencePoses& reference);

/// By the word of somebody who saw the robot's first turn of `kFirstTurn_rad` or more.
[[nodiscard]] Handedness compare_first_turn(std::vector<MatchRow> matches, bool was_left);

constexpr double kFirstTurn_rad = 0.5235987755982988;

/// Sectors of the laser's own bearings in which it sees the same near thing however the robot moves: the robot itself.
struct OwnSectors {
  std::vector<AngleSector> sectors{};  ///< counter-clockwise, in the laser's bearings
  double travel_m = 0.0;
  double turned_rad = 0.0;
  bool is_told = false;  ///< the robot moved enough to tell
};

struct OwnSectorParams {
  double range_max_m = 1.5;    ///< farther things are not the robot
  double spread_max_m = 0.06;  ///< from the 10th to the 90th percentile of a beam's ranges
};

[[nodiscard]] OwnSectors find_own_sectors(const ScanLog& log, std::span<const MatchRow> matches, const ScanParams& scan,
                                          const OwnSectorParams& params = {});

/// Sectors of the laser's bearings in those of a mount, rounded outwards to whole degrees.
[[nodiscard]] std::vector<AngleSector> sectors_on(std::span<const AngleSector> sectors, const LaserPlace& laser);

}  // namespace odoless
