#pragma once

#include <string>
#include <vector>

#include "tools/log/scan_log.hpp"

namespace odoless {

/// What a log's numbers say against being a laser's.
struct Plausibility {
  std::vector<std::string> corrected;  ///< what was corrected, a sentence each
  /// What cannot be corrected without guessing, and what would be right; empty: nothing.
  std::string wrong;
  std::string right;

  [[nodiscard]] bool is_plausible() const { return wrong.empty(); }
};

/// Holds a log against what any laser range finder can do: 0.2 to 200 scans a second, ranges of metres, at most a full
/// turn. Corrects in the log what can only have one meaning, and says so:
///
/// - stamps in milliseconds, micro- or nanoseconds, or divided by 1000;
/// - ranges in millimetres, where centimetres would not do;
/// - angles in degrees;
/// - scans that are not in the order of their stamps, where their ranges say that the stamps are right.
///
/// What may have several meanings is told and left: stamps that run backwards, or belong to other scans; ranges of no
/// known unit; beams that reach over more than a turn, or with whose angle step walls are bent.
[[nodiscard]] Plausibility make_plausible(ScanLog& log);

/// Reads a log and makes it plausible. @throws DataError also for what is wrong with it; what `read_scan_log` throws.
/// @param corrected  Gets what was corrected, and what was passed over.
[[nodiscard]] ScanLog read_plausible_log(const std::filesystem::path& path, const LogChoice& choice,
                                         std::vector<std::string>& corrected);

}  // namespace odoless
