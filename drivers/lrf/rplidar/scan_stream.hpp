#pragma once

#include <cstdint>
#include <span>

#include "drivers/lrf/arrival_clock.hpp"
#include "drivers/lrf/lrf_params.hpp"
#include "drivers/lrf/rplidar/point_reader.hpp"
#include "drivers/lrf/turn_scans.hpp"

namespace odoless::rplidar {

/// How a device scans.
struct ScanMode {
  const CapsuleFormat* format = nullptr;  ///< null: nodes
  std::int64_t sample_ns = 0;
  double range_max_m = 0.0;
};

/// The stream of turns of one device.
///
/// The device sends no stamp, but it samples evenly: the number of a sample, times what the device says that a sample
/// takes, is its time. Beams go clockwise from the front, so the angle step is negative.
/// Thread: one thread. Real time: no allocation after construction.
class ScanStream {
 public:
  ScanStream(const LrfParams& params, int beams_max);

  /// A stream is about to start. Errc::kTooManyBeams: more than there is memory for.
  [[nodiscard]] Errc configure(const ScanMode& mode, int line_baud);

  [[nodiscard]] const LrfGeometry& geometry() const { return scans_.geometry(); }

  /// Takes bytes off the front of `bytes`, up to the end of a turn or the first fault. A scan, or why there is none:
  /// Errc::kOk (all bytes are used), kWrongSum, kFrameMalformed (bytes had to be skipped), kWrongCount (a turn that
  /// lacks too many points, or of which something may have been wrong).
  [[nodiscard]] FoundScan take(std::span<const std::byte>& bytes, std::int64_t arrival_ns);

  [[nodiscard]] std::uint64_t identical_run() const { return scans_.identical_run(); }

 private:
  [[nodiscard]] bool take_points();

  TurnScans scans_;
  PointReader reader_;
  ArrivalClock clock_{250'000'000};
  ScanMode mode_;
  std::int64_t transfer_ns_ = 0;  ///< of a node or a capsule
  std::size_t next_point_ = 0;    ///< of the reader's points; the rest waits for the next call
};

}  // namespace odoless::rplidar
