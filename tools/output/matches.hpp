#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "core/geometry/pose2.hpp"

namespace odoless {

/// One match of a scan with the scan before it; indices count the scans of the log from 0.
struct MatchRow {
  int reference_index = 0;
  int index = 0;
  double reference_stamp_s = 0.0;
  double stamp_s = 0.0;
  Pose2 reference_T_scan;
  double fitness = 0.0;  ///< 0..1
  int evaluations = 0;
  double time_us = 0.0;  ///< CPU time of this match
  bool converged = false;
};

/// The text of a matches.csv: a header that names columns and units, then one line per row; metres and radians with 6
/// decimals, `converged` as 1 or 0.
[[nodiscard]] std::string format_matches(std::span<const MatchRow> rows);

/// Writes it, whole or not at all. @throws CannotCreateError, IoError.
void write_matches(const std::filesystem::path& path, std::span<const MatchRow> rows);

/// Reads it back. @throws DataError (another header, a malformed line), NoInputError, IoError.
[[nodiscard]] std::vector<MatchRow> read_matches(const std::filesystem::path& path);

}  // namespace odoless
