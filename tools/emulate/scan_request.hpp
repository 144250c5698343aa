#pragma once

#include <string>
#include <string_view>

#include "tools/emulate/scip_model.hpp"

namespace odoless::scip {

/// What MD, MS, ME, GD, GS or GE ask for, and of lasers that tell several echoes ND, NE, HD or HE, or the status that
/// refuses it.
struct ScanRequest {
  std::string status = "00";
  std::string text;  ///< as received; the echo
  bool is_stream = false;
  bool has_echoes = false;  ///< all of a beam, and not the first alone
  char reading = 'D';       ///< D: ranges, S: short ranges, E: ranges and intensities
  int first_step = 0;
  int last_step = 0;
  int cluster = 1;
  int skip = 0;
  int count = 0;  ///< 0: until QT

  /// The echo above a scan of a stream: instead of the count, how many scans are left.
  [[nodiscard]] std::string echo(int left) const;
};

[[nodiscard]] bool is_scan_request(std::string_view text, const ScipModel& model);

/// Reads a request as the model does.
[[nodiscard]] ScanRequest parse_scan_request(std::string_view text, const ScipModel& model);

}  // namespace odoless::scip
