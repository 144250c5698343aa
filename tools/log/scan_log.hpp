#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/scan/scan_frame.hpp"
#include "tools/log/line_reader.hpp"

namespace odoless {

/// One scan of a recorded log. It has no pose and no odometry, on purpose: what is not here cannot reach the SLAM.
struct LogScan {
  std::int64_t stamp_ns = 0;
  double start_angle_rad = 0.0;
  double angle_step_rad = 0.0;
  std::int64_t first_beam_ns = 0;                              ///< of beam 0, after the stamp
  std::int64_t beam_period_ns = 0;                             ///< from beam to beam; 0: unknown
  float no_return_m = std::numeric_limits<float>::infinity();  ///< this range or more is no return
  bool is_level = true;                                        ///< false: 2D SLAM is not given it
  std::vector<float> ranges_m;                                 ///< as recorded: also 0, inf and NaN

  /// A view, valid while this scan lives unchanged.
  [[nodiscard]] RawScan raw() const {
    return {.stamp_ns = stamp_ns,
            .start_angle_rad = start_angle_rad,
            .angle_step_rad = angle_step_rad,
            .first_beam_ns = first_beam_ns,
            .beam_period_ns = beam_period_ns,
            .no_return_m = no_return_m,
            .ranges_m = ranges_m};
  }
};

struct ScanLog {
  std::string format;       ///< for people, such as "CARMEN FLASER"
  bool has_stamps = false;  ///< false: the stamps are index * default_period_ns
  int stamp_digits = 9;     ///< of nanoseconds in the unit of the file's stamps; less than 9: they were no seconds
  std::vector<LogScan> scans;
  std::vector<std::string> passed_over{};  ///< what was damaged or missing in the file, a sentence each
};

constexpr std::int64_t kDefaultPeriodNs = 200'000'000;

/// What is wanted of a log, beyond its path.
struct LogChoice {
  std::int64_t default_period_ns = kDefaultPeriodNs;  ///< where the log has no stamps
  std::string topic;                                  ///< of a log of messages; empty: the only one with scans
};

/// Messages of one name in a log.
struct LogTopic {
  std::string name;
  std::string type;
  bool has_scans = false;  ///< its messages are scans that can be read
  std::int64_t messages = 0;
  std::int64_t first_ns = 0;  ///< when they were recorded
  std::int64_t last_ns = 0;
};

/// Reads a whole log of any supported format, plain or packed; format and packing are told from the content.
///
/// - CARMEN `FLASER` and `ROBOTLASER1`: of the two, the kind that comes first counts, since some loggers write each
///   scan as both. Other messages are skipped. Stamps are the ipc_timestamp.
/// - DP-SLAM `Laser n ranges...`: -90 to +90 deg, no stamps, 8.0 m and more is no return.
/// - CSV `t,angle_min,angle_inc,time_inc,scan_time,rmin,rmax,n,ranges...`, rmax and more is no return; time_inc is the
///   time from beam to beam, t that of the first.
/// - Logs of messages (LCM, ROS, MCAP, MRPT), as formats/README.md has them. Stamps are the messages' own.
///
/// Each scan has at least one range and a finite geometry with a step other than 0. Stamps that are missing, all equal
/// or all zero are replaced by index * default_period_ns; stamps that go backwards are kept. Where the first stamp is
/// beyond +-292 years in seconds, all are taken for milli-, micro- or nanoseconds. Stamps are in whole
/// microseconds and angles of float precision, so that a scan that went over LCM is the very same.
///
/// @throws DataError for a malformed line, a cut file, a log without any scan, or with scans of several topics of which
///         none was chosen; NoInputError, IoError.
[[nodiscard]] ScanLog read_scan_log(const std::filesystem::path& path, const LogChoice& choice = {});

/// What is in a log of messages; empty for other logs. @throws as read_scan_log.
[[nodiscard]] std::vector<LogTopic> read_topics(const std::filesystem::path& path);

/// The same from lines that somebody else opened.
[[nodiscard]] ScanLog read_scan_log(LineReader& lines, std::int64_t default_period_ns = kDefaultPeriodNs);

}  // namespace odoless
