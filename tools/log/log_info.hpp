#pragma once

#include <array>
#include <string>

#include "core/scan/scan_time.hpp"
#include "tools/eval/statistics.hpp"
#include "tools/log/scan_log.hpp"

namespace odoless {

/// Of a log that does not tell when the beams of a scan were measured.
constexpr const char* kSweepNotTold =
    "not told, so that the motion during a scan stays in it; where the laser takes long, say how long in "
    "lrf.mount.sweep_ms, which `odoless calibrate sweep` finds";

/// What a log holds, at a glance.
struct LogInfo {
  std::string format;
  std::size_t scans = 0;
  std::size_t beams_min = 0;
  std::size_t beams_max = 0;
  double angle_min_rad = 0.0;  ///< of all beams of all scans
  double angle_max_rad = 0.0;
  double angle_step_min_rad = 0.0;
  double angle_step_max_rad = 0.0;
  bool has_stamps = false;
  ScanTimeFindings times{};   ///< what the stamps are like
  double sweep_s = 0.0;       ///< the beams of the first scan; 0 where the log does not tell when beams were measured
  double duration_s = 0.0;    ///< from the oldest scan to the newest
  double rate_hz = 0.0;       ///< 0 without duration
  double return_share = 0.0;  ///< 0..1 of all beams, as the SLAM would classify them with its defaults
  double no_return_share = 0.0;
  double invalid_share = 0.0;
  Statistics range_m;  ///< of the returns
  double range_min_m = 0.0;
};

/// @throws DataError naming `name` when a scan has more beams than the product can take.
[[nodiscard]] LogInfo summarise(const ScanLog& log, const std::string& name);

}  // namespace odoless
