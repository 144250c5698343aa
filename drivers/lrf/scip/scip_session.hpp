#pragma once

#include "drivers/lrf/scip/bring_up.hpp"
#include "drivers/lrf/scip/reply_reader.hpp"
#include "drivers/lrf/scip/scan_stream.hpp"
#include "drivers/lrf/streaming_session.hpp"

namespace odoless {

/// Hokuyo's SCIP 2.0 (URG, UBG, UHG, UTM, UST): brings the device up, decodes its stream, and brings it up again when
/// it ends, stalls or tells of a fault. [kawata2005scip]
///
/// One damaged byte costs at most one scan. Contract: see LrfSession.
class ScipSession final : public StreamingSession<scip::ScanStream, scip::BringUp> {
 public:
  /// @param beams_max  Most beams of a scan; a device that has more is refused with Errc::kTooManyBeams.
  ScipSession(const LrfParams& params, int beams_max);

  void receive(std::span<const std::byte> bytes, std::int64_t arrival_ns, LrfSink& sink) override;

 private:
  /// @param characters_max  Of the data of a scan.
  ScipSession(const LrfParams& params, int beams_max, std::size_t characters_max);

  void forget_received() override;
  void on_reply(std::int64_t arrival_ns, LrfSink& sink);
  void on_stream_reply(const scip::Reply& reply, std::int64_t arrival_ns, LrfSink& sink);
  void on_device_status(scip::Status device_status, std::int64_t now_ns, LrfSink& sink);
  void reject(Errc reason, LrfSink& sink);

  scip::ReplyReader reader_;
};

}  // namespace odoless
