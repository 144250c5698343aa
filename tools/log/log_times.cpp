#include "tools/log/log_times.hpp"

#include "core/scan/scan_clock.hpp"

namespace odoless {

LogTimes times_of(const ScanLog& log, int every) {
  LogTimes out;
  ScanClock clock;
  for (std::size_t i = 0; i < log.scans.size(); i += static_cast<std::size_t>(every)) {
    out.times.push_back(clock.next(log.scans[i].stamp_ns));
  }
  out.findings = clock.findings();
  return out;
}

}  // namespace odoless
