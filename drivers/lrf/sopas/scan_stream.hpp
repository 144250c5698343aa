#pragma once

#include <cstdint>
#include <vector>

#include "drivers/lrf/device_clock.hpp"
#include "drivers/lrf/lrf_params.hpp"
#include "drivers/lrf/lrf_session.hpp"
#include "drivers/lrf/range_buffer.hpp"
#include "drivers/lrf/sopas/scan_data.hpp"

namespace odoless::sopas {

/// A bearing of SICK's, which counts from the right of the device (front: 90 deg), in the scan frame. rad.
[[nodiscard]] double bearing_rad(double sick_deg);

/// The step that a device means, which tells it in whole ten-thousandths of a degree: 3333 is a third. deg.
[[nodiscard]] double step_deg(int step_tmdeg);

/// The stream of scans of one device, and what its telegrams mean.
///
/// Its clock tells two times of each scan: one of its mirror, and when it was sent. The second puts its clock on the
/// host's, the first is the scan's. Which of the mirror's it is, the zero index before the scan or the scan's end,
/// differs from model to model: what was sent sooner after it than a scan takes was measured before it.
/// Thread: one thread. Real time: no allocation after construction.
class ScanStream {
 public:
  ScanStream(const LrfParams& params, int beams_max);

  /// The scan in a telegram; its beams are there until the next. Errors: see scan_data_of.
  [[nodiscard]] Result<ScanData> read(const Telegram& telegram);

  /// Fits to what the device sends. @param scans_per_telegram  It sends one of so many. Errc::kBadGeometry: it cannot
  /// be.
  [[nodiscard]] Errc configure(const ScanData& first, int scans_per_telegram = 1);

  [[nodiscard]] const LrfGeometry& geometry() const { return geometry_; }

  /// The scan that was read last. Errc::kWrongCount: it is another than was configured; kImplausibleStamp.
  [[nodiscard]] Result<LrfScan> scan(const ScanData& data, std::int64_t arrival_ns);

  [[nodiscard]] std::uint64_t identical_run() const { return buffer_.identical_run(); }
  [[nodiscard]] std::uint64_t clock_resets() const { return clock_.resets(); }

 private:
  [[nodiscard]] float range_m(std::uint16_t count) const;

  std::vector<std::uint16_t> counts_;
  RangeBuffer buffer_;
  LrfGeometry geometry_;
  ScanShape shape_;
  DeviceClock clock_;
  std::uint32_t last_stamp_us_ = 0;
  std::int64_t stamp_us_ = std::int64_t{1} << 40;  ///< the same, without wraps; never below 0
  std::int64_t beam_period_ns_ = 0;
  std::int64_t to_first_beam_ns_ = 0;  ///< from the device's stamp; negative: it is that of the scan's end
};

}  // namespace odoless::sopas
