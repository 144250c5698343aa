#pragma once

#include "drivers/lrf/lrf_params.hpp"
#include "drivers/lrf/lrf_session.hpp"
#include "drivers/lrf/scip/bring_up.hpp"
#include "drivers/lrf/scip/reply_reader.hpp"
#include "drivers/lrf/scip/scan_stream.hpp"

namespace odoless {

/// Hokuyo's SCIP 2.0 (URG, UBG, UHG, UTM, UST): brings the device up, decodes its stream, and brings it up again when
/// it ends, stalls or tells of a fault. [kawata2005scip]
///
/// One damaged byte costs at most one scan. Contract: see LrfSession.
class ScipSession final : public LrfSession {
 public:
  /// @param beams_max  Most beams of a scan; a device that has more is refused with Errc::kTooManyBeams.
  ScipSession(const LrfParams& params, int beams_max);

  void reset(std::int64_t now_ns) override;
  void receive(std::span<const std::byte> bytes, std::int64_t arrival_ns, LrfSink& sink) override;
  [[nodiscard]] std::span<const std::byte> transmit() override;
  void tick(std::int64_t now_ns, LrfSink& sink) override;
  [[nodiscard]] std::int64_t next_deadline_ns() const override;
  [[nodiscard]] int line_baud() const override { return bring_up_.line_baud(); }
  [[nodiscard]] bool ready() const override { return bring_up_.done(); }
  [[nodiscard]] const LrfGeometry& geometry() const override { return stream_.geometry(); }
  [[nodiscard]] const LrfCounters& counters() const override { return counters_; }

 private:
  void start_over(std::int64_t now_ns, bool with_reset);
  void on_reply(std::int64_t arrival_ns, LrfSink& sink);
  void on_stream_reply(const scip::Reply& reply, std::int64_t arrival_ns, LrfSink& sink);
  void on_device_status(scip::Status device_status, std::int64_t now_ns, LrfSink& sink);
  void reject(Errc reason, LrfSink& sink);

  scip::ReplyReader reader_;
  scip::ScanStream stream_;
  scip::BringUp bring_up_;
  LrfCounters counters_;
  std::int64_t stall_timeout_ns_;
  std::int64_t last_scan_ns_ = 0;
  std::uint64_t stream_device_errors_ = 0;
  bool was_reset_ = false;
};

}  // namespace odoless
