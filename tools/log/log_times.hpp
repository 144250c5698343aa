#pragma once

#include <vector>

#include "core/scan/scan_time.hpp"
#include "tools/log/scan_log.hpp"

namespace odoless {

/// When the scans of a log were taken, as well as its stamps tell.
struct LogTimes {
  std::vector<ScanTime> times;  ///< of every scan used
  ScanTimeFindings findings{};
};

/// Of every `every`-th scan, in the order of the log.
[[nodiscard]] LogTimes times_of(const ScanLog& log, int every);

}  // namespace odoless
