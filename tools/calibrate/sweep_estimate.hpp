#pragma once

#include <cstdint>
#include <functional>

#include "config/robot_params.hpp"
#include "tools/log/scan_log.hpp"

namespace odoless {

/// How long a laser takes for the beams of one scan, by how well its scans match with the motion of that time taken out
/// of them: laser odometry over the log with one sweep after the other, compared in the scans that were taken in turns.
struct SweepEstimate {
  static constexpr int kTurnScans_min = 30;
  static constexpr double kTurn_min_rad = 0.03;  ///< from scan to scan; less shears none of them visibly

  enum class Verdict {
    kUnknown,  ///< too few scans were taken in a turn, or they match as well with any sweep
    kShort,    ///< none is clearly better than none at all, and one of a whole period either way is clearly worse
    kSweep     ///< `sweep_ns` is clearly better than none at all
  };

  Verdict verdict = Verdict::kUnknown;
  std::int64_t sweep_ns = 0;   ///< as in LaserMountParams: below 0 where the last beam is measured first
  std::int64_t period_ns = 0;  ///< of the scans, the median
  int turn_scans = 0;          ///< scans in turns fast enough to tell
  double better = 1.0;         ///< score of those scans with the best sweep, over their score with none
};

/// Called with the runs over the log that are done, and those that there may be.
using SweepProgress = std::function<void(int done, int total)>;

/// Tells sweeps to a quarter of the scans' period, of at most 0.5 s. `params.mount.sweep_ns` is not used.
/// @pre two or more scans, which do not tell their beams' times
[[nodiscard]] SweepEstimate estimate_sweep(const ScanLog& log, const RobotParams& params,
                                           const SweepProgress& progress);

}  // namespace odoless
