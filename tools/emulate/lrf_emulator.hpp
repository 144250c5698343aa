#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <string>

#include "tools/emulate/emulated_line.hpp"
#include "tools/emulate/emulated_lrf.hpp"

namespace odoless {

struct LrfEmulatorOptions {
  std::string truth{};  ///< file to write; empty: none
  std::int64_t duration_ns = std::numeric_limits<std::int64_t>::max();
  bool stops_at_end = false;  ///< when the drive or the log is over
};

/// What an emulation has done.
struct LrfEmulation {
  std::int64_t scans = 0;    ///< handed to the line as a whole
  std::int64_t dropped = 0;  ///< because the client didn't read
};

/// Serves an emulated laser on a line in real time, until SIGTERM, SIGINT, the duration or the end.
///
/// Each scan that is sent adds a TUM line to the truth: when its first beam was measured (the monotonic clock moved to
/// the Unix epoch as it is when this starts, which is what the daemon stamps with) and where the robot was.
/// @param on_end  Called once, when the drive or the log is over.
/// @throws CannotCreateError, IoError for the truth.
LrfEmulation emulate_lrf(EmulatedLrf& device, const ScanSource& source, EmulatedLine& line,
                         const LrfEmulatorOptions& options, const std::function<void()>& on_end);

}  // namespace odoless
