#pragma once

#include "drivers/lrf/sick/bring_up.hpp"
#include "drivers/lrf/sick/scan_stream.hpp"
#include "drivers/lrf/sick/telegram.hpp"
#include "drivers/lrf/streaming_session.hpp"

namespace odoless {

/// SICK LMS200, LMS211, LMS220, LMS221, LMS291: brings the device up, decodes its stream, and brings it up again when
/// it ends, stalls or tells of a fault.
///
/// One damaged byte costs at most one scan. Contract: see LrfSession.
class SickSession final : public StreamingSession<sick::ScanStream, sick::BringUp> {
 public:
  /// @param beams_max  Most beams of a scan; a variant that has more is refused with Errc::kTooManyBeams.
  SickSession(const LrfParams& params, int beams_max);

  /// From the next `reset` on, the device is only asked what it is set to, and keeps it: no write, no other variant or
  /// rate, no stream. `ready` is when `found` is known.
  void only_ask() { bring_up().only_ask(); }
  [[nodiscard]] const sick::Found& found() { return bring_up().found(); }

  void receive(std::span<const std::byte> bytes, std::int64_t arrival_ns, LrfSink& sink) override;

 private:
  void forget_received() override;
  void on_telegram(std::int64_t arrival_ns, LrfSink& sink);
  void on_stream_telegram(const sick::Telegram& telegram, std::int64_t arrival_ns, LrfSink& sink);
  void on_status(int device_status, std::int64_t now_ns, LrfSink& sink);

  sick::TelegramReader reader_;
  int last_severity_ = 0;
};

}  // namespace odoless
