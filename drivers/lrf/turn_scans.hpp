#pragma once

#include <cstdint>
#include <optional>

#include "drivers/lrf/lrf_session.hpp"
#include "drivers/lrf/range_buffer.hpp"
#include "drivers/lrf/rplidar/turn.hpp"

namespace odoless {

/// A scan, or why there is none; neither: nothing yet.
struct FoundScan {
  std::optional<LrfScan> scan;
  Errc error = Errc::kOk;
};

/// Makes scans of evenly spaced beams, clockwise from the front, of the points of a laser that turns all the time.
/// Thread: one thread. Real time: no allocation after construction.
class TurnScans {
 public:
  /// @param like  Beams, ranges and the period until a turn was seen.
  /// @param miss_lag_deg  See rplidar::Turn.
  TurnScans(const LrfGeometry& like, int beams_max, double miss_lag_deg);

  /// A stream is about to start. Errc::kTooManyBeams: more than there is memory for.
  [[nodiscard]] Errc start();
  void set_range_max(double range_max_m) { geometry_.range_max_m = range_max_m; }

  /// A point that was measured at `time_ns`. @return whether it completes a turn: `finish` it now.
  [[nodiscard]] bool add(const rplidar::Point& point, std::int64_t time_ns) {
    return turn_.add(point, time_ns) && turn_.is_whole();
  }

  /// Of the complete turn: the scan, or Errc::kWrongCount (it lacks too many points, or something of it may have been
  /// wrong).
  [[nodiscard]] FoundScan finish(std::int64_t arrival_ns);

  /// What is collected may have been wrong.
  void spoil() { turn_.spoil(); }
  /// Forgets what is collected.
  void clear() { turn_.clear(); }

  [[nodiscard]] const LrfGeometry& geometry() const { return geometry_; }
  [[nodiscard]] std::uint64_t identical_run() const { return buffer_.identical_run(); }

 private:
  LrfGeometry geometry_;
  std::int64_t nominal_period_ns_;
  RangeBuffer buffer_;
  rplidar::Turn turn_;
  std::int64_t last_stamp_ns_ = 0;
};

}  // namespace odoless
