#pragma once

#include "drivers/lrf/rplidar/bring_up.hpp"
#include "drivers/lrf/rplidar/scan_stream.hpp"
#include "drivers/lrf/streaming_session.hpp"

namespace odoless {

/// Slamtec RPLIDAR, A series: brings the device up, makes scans of evenly spaced beams from its points, and brings it
/// up again when the stream ends or stalls.
///
/// One damaged byte costs at most one scan. The standard scan has no sums: a byte that changes a range within what is
/// possible cannot be told. Contract: see LrfSession.
class RplidarSession final : public StreamingSession<rplidar::ScanStream, rplidar::BringUp> {
 public:
  /// @param beams_max  Most beams of a scan; more in `params` are refused with Errc::kTooManyBeams.
  RplidarSession(const LrfParams& params, int beams_max);

  void receive(std::span<const std::byte> bytes, std::int64_t arrival_ns, LrfSink& sink) override;
  [[nodiscard]] std::span<const std::byte> transmit() override { return bring_up().take_request(); }

 private:
  void forget_received() override {}  // the bring-up does, and each stream begins with nothing
  void on_found(const rplidar::ScanStream::Found& found, LrfSink& sink);
};

}  // namespace odoless
