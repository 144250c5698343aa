#pragma once

#include "drivers/lrf/lrf_params.hpp"
#include "drivers/lrf/lrf_session.hpp"
#include "drivers/lrf/rplidar/bring_up.hpp"
#include "drivers/lrf/rplidar/scan_stream.hpp"

namespace odoless {

/// Slamtec RPLIDAR, A series: brings the device up, makes scans of evenly spaced beams from its points, and brings it
/// up again when the stream ends or stalls.
///
/// One damaged byte costs at most one scan. The standard scan has no sums: a byte that changes a range within what is
/// possible cannot be told. Contract: see LrfSession.
class RplidarSession final : public LrfSession {
 public:
  /// @param beams_max  Most beams of a scan; more in `params` are refused with Errc::kTooManyBeams.
  RplidarSession(const LrfParams& params, int beams_max);

  void reset(std::int64_t now_ns) override;
  void receive(std::span<const std::byte> bytes, std::int64_t arrival_ns, LrfSink& sink) override;
  [[nodiscard]] std::span<const std::byte> transmit() override { return bring_up_.take_request(); }
  void tick(std::int64_t now_ns, LrfSink& sink) override;
  [[nodiscard]] std::int64_t next_deadline_ns() const override;
  [[nodiscard]] int line_baud() const override { return bring_up_.line_baud(); }
  [[nodiscard]] bool ready() const override { return bring_up_.done(); }
  [[nodiscard]] const LrfGeometry& geometry() const override { return stream_.geometry(); }
  [[nodiscard]] const LrfCounters& counters() const override { return counters_; }

 private:
  void start_over(std::int64_t now_ns);
  void on_found(const rplidar::ScanStream::Found& found, std::int64_t arrival_ns, LrfSink& sink);

  rplidar::ScanStream stream_;
  rplidar::BringUp bring_up_;
  LrfCounters counters_;
  std::int64_t stall_timeout_ns_;
  std::int64_t last_scan_ns_ = 0;
  bool was_reset_ = false;
};

}  // namespace odoless
