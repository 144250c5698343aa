#pragma once

#include "drivers/lrf/lrf_params.hpp"
#include "drivers/lrf/lrf_session.hpp"
#include "drivers/lrf/sick/bring_up.hpp"
#include "drivers/lrf/sick/scan_stream.hpp"
#include "drivers/lrf/sick/telegram.hpp"

namespace odoless {

/// SICK LMS200, LMS211, LMS220, LMS221, LMS291: brings the device up, decodes its stream, and brings it up again when
/// it ends, stalls or tells of a fault.
///
/// One damaged byte costs at most one scan. Contract: see LrfSession.
class SickSession final : public LrfSession {
 public:
  /// @param beams_max  Most beams of a scan; a variant that has more is refused with Errc::kTooManyBeams.
  SickSession(const LrfParams& params, int beams_max);

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
  void start_over(std::int64_t now_ns, bool with_reset);
  void on_telegram(std::int64_t arrival_ns, LrfSink& sink);
  void on_stream_telegram(const sick::Telegram& telegram, std::int64_t arrival_ns, LrfSink& sink);
  void on_status(int device_status, std::int64_t now_ns, LrfSink& sink);

  sick::TelegramReader reader_;
  sick::ScanStream stream_;
  sick::BringUp bring_up_;
  LrfCounters counters_;
  std::int64_t stall_timeout_ns_;
  std::int64_t last_scan_ns_ = 0;
  std::uint64_t stream_device_errors_ = 0;
  int last_severity_ = 0;
  bool was_reset_ = false;
};

}  // namespace odoless
