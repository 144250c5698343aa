#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "tools/log/line_reader.hpp"
#include "tools/log/scan_log.hpp"

namespace odoless {

/// An angle as a servo tells it.
struct ServoAngle {
  std::int64_t stamp_ns = 0;  ///< on the servo's clock
  double angle_rad = 0.0;     ///< from the servo's own zero, in its own sense
};

/// Scans of a laser on a tilt servo, and the servo's angles; each with stamps on a clock of its own.
struct TiltLog {
  std::vector<ServoAngle> angles;  ///< in the order of their stamps, none twice
  std::vector<LogScan> scans;      ///< in the order of their stamps, none twice
  int empty_rows = 0;              ///< rows without a scan
  int doubled_scans = 0;           ///< rows whose scan is not later than the one before
  /// Of the rows, the middle difference of the servo's stamp from the scan's: what the two clocks differ by, give or
  /// take how a row's angle and scan came together.
  std::int64_t row_offset_ns = 0;
};

/// Reads CSV, plain, .gz or .xz, a scan and an angle per row:
/// `t,servo stamp,servo angle in deg,scan stamp,angle_min,angle_max,angle_inc,time_inc,rmin,rmax,n,ranges...`
/// A range of 0, inf or nan says nothing; one above rmax counts, for some lasers measure farther than they say.
/// @throws DataError for a malformed line or a log with fewer than two scans or angles; NoInputError, IoError.
[[nodiscard]] TiltLog read_tilt_log(const std::filesystem::path& path);
[[nodiscard]] TiltLog read_tilt_log(LineReader& lines);

/// Whether a file's first line is a row of such a log. @throws NoInputError, IoError.
[[nodiscard]] bool is_tilt_log(const std::filesystem::path& path);

/// The log as such a file: each scan with the first angle that is not older by its stamp less `servo_ahead_ns`.
[[nodiscard]] std::string tilt_csv(const TiltLog& log, std::int64_t servo_ahead_ns);

}  // namespace odoless
