#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "drivers/lrf/csv/scan_line.hpp"
#include "drivers/lrf/device_clock.hpp"
#include "drivers/lrf/lrf_params.hpp"
#include "drivers/lrf/lrf_session.hpp"
#include "drivers/lrf/range_buffer.hpp"

namespace odoless::csv {

/// The stream of scans of one sender, all of one shape. Its stamps, if it has some, are put on the host's clock;
/// without, a scan was complete when it arrived. Thread: one thread. Real time: no allocation after construction.
class ScanStream {
 public:
  ScanStream(const LrfParams& params, int beams_max);

  /// A line; its ranges are there until the next. Errors: see scan_line_of.
  [[nodiscard]] Result<ScanLine> read(std::string_view line) { return scan_line_of(line, ranges_m_); }

  /// Fits to what is sent, once per `period_ns`.
  void configure(const ScanLine& first, std::int64_t period_ns);
  [[nodiscard]] const LrfGeometry& geometry() const { return geometry_; }

  /// The line that was read last. Errc::kWrongCount: its shape is another than was configured; kImplausibleStamp.
  [[nodiscard]] Result<LrfScan> scan(const ScanLine& line, std::int64_t arrival_ns);

  [[nodiscard]] std::uint64_t identical_run() const { return buffer_.identical_run(); }
  [[nodiscard]] std::uint64_t clock_resets() const { return clock_.resets(); }

 private:
  std::vector<float> ranges_m_;
  RangeBuffer buffer_;
  LrfGeometry geometry_;
  ScanShape shape_;
  DeviceClock clock_;
  std::int64_t beam_period_ns_ = 0;
  std::int64_t sweep_ns_ = 0;
  std::int64_t last_stamp_ns_ = 0;
};

}  // namespace odoless::csv
