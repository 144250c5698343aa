#pragma once

#include <cmath>
#include <string>
#include <string_view>

#include "tests/support/temporary_file.hpp"
#include "tools/command/error.hpp"
#include "tools/log/log_info.hpp"
#include "tools/log/plausibility.hpp"
#include "tools/log/scan_log.hpp"

namespace odoless::test {

/// What read_scan_log promises of a log that it has accepted; empty when it holds, else what is broken.
inline std::string broken_promise(const ScanLog& log) {
  if (log.scans.empty() || log.format.empty()) {
    return "a log without scans or format";
  }
  for (std::size_t i = 0; i < log.scans.size(); ++i) {
    const LogScan& scan = log.scans[i];
    if (scan.ranges_m.empty()) {
      return "a scan without ranges";
    }
    if (!std::isfinite(scan.start_angle_rad) || !std::isfinite(scan.angle_step_rad) || scan.angle_step_rad == 0.0) {
      return "a scan without geometry";
    }
    if (!(scan.no_return_m > 0.0F)) {
      return "a code for no return that is no range";
    }
    if (!log.has_stamps && scan.stamp_ns != static_cast<std::int64_t>(i) * kDefaultPeriodNs) {
      return "a log without stamps whose scans are not counted";
    }
  }
  return "";
}

/// Reads a log: true for one, false for a DataError; anything else is let through.
template <class Read>
bool reads(const Read& read, std::string& broken) {
  try {
    const ScanLog log = read();
    broken = broken_promise(log);
    ScanLog plausible = log;
    if (make_plausible(plausible).is_plausible() && broken.empty()) {
      broken = broken_promise(plausible);
    }
    static_cast<void>(summarise(log, "bytes"));
    return true;
  } catch (const DataError&) {
    return false;
  }
}

/// Reads whatever text these bytes are.
inline bool read_any_bytes(std::string_view bytes, std::string& broken) {
  return reads(
      [bytes] {
        LineReader lines(view_bytes(bytes, "bytes"), "bytes");
        return read_scan_log(lines);
      },
      broken);
}

/// Reads whatever file these bytes are, as commands do.
inline bool read_any_file(std::string_view bytes, std::string& broken) {
  const TemporaryFile file(bytes);
  return reads(
      [&file] {
        static_cast<void>(read_topics(file.path()));
        return read_scan_log(file.path());
      },
      broken);
}

}  // namespace odoless::test
