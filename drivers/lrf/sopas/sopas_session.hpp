#pragma once

#include "drivers/lrf/sopas/bring_up.hpp"
#include "drivers/lrf/sopas/scan_stream.hpp"
#include "drivers/lrf/sopas/telegram.hpp"
#include "drivers/lrf/streaming_session.hpp"

namespace odoless {

/// SICK's TiM5xx, LMS1xx, LMS4xxx and their kin, which speak SOPAS: brings the device up, decodes its stream, and
/// brings it up again when it ends, stalls or becomes another.
///
/// In CoLa B, one damaged byte costs at most one scan. CoLa A has no check sums: what damages it may change a range.
/// Contract: see LrfSession.
class SopasSession final : public StreamingSession<sopas::ScanStream, sopas::BringUp> {
 public:
  /// @param beams_max  Most beams of a scan; a device that has more is refused with Errc::kTooManyBeams.
  SopasSession(const LrfParams& params, int beams_max);

  void receive(std::span<const std::byte> bytes, std::int64_t arrival_ns, LrfSink& sink) override;

 private:
  void forget_received() override { reader_.clear(); }
  void on_telegram(std::int64_t arrival_ns, LrfSink& sink);
  void on_scan(const Result<sopas::ScanData>& data, std::int64_t arrival_ns, LrfSink& sink);
  void on_status(int device_status, LrfSink& sink);

  sopas::TelegramReader reader_;
  int last_status_ = 0;
};

}  // namespace odoless
