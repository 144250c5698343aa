#pragma once

#include <optional>

#include "tools/log/fields.hpp"
#include "tools/log/scan_log.hpp"

namespace odoless {

/// A scan of one line; without a stamp when the line tells none.
struct LineScan {
  LogScan scan;
  bool has_stamp = false;
};

/// How one format writes its scans.
struct ScanFormat {
  const char* name;
  char separator;
  /// Whether a line is one of this format's scans, from its first characters.
  bool (*is_scan)(std::string_view line);
  /// Whether a line that is no scan may be passed over.
  bool (*may_skip)(std::string_view line);
  /// Reads a scan; @throws DataError.
  LineScan (*parse)(const Fields& fields);
};

/// The format whose scan this line is, or null.
[[nodiscard]] const ScanFormat* find_scan_format(std::string_view line);

}  // namespace odoless
