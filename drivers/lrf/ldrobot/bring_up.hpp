#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "drivers/lrf/bring_up_steps.hpp"
#include "drivers/lrf/ldrobot/packet.hpp"
#include "drivers/lrf/ldrobot/scan_stream.hpp"
#include "drivers/lrf/lrf_params.hpp"
#include "drivers/lrf/lrf_session.hpp"
#include "drivers/lrf/packet_listener.hpp"
#include "drivers/lrf/rate_search.hpp"

namespace odoless::ldrobot {

enum class Step : std::uint8_t { kListen, kPause, kDone };

/// The device takes no commands and streams as soon as it has power. It is listened to until some packets in a row make
/// sense; where no rate of the line is set, at one rate after the other.
///
/// Thread: one thread. Real time: no allocation.
class BringUp final : public BringUpSteps<ScanStream, Step> {
 public:
  BringUp(const LrfParams& params, ScanStream& stream);

  void start(std::int64_t now_ns, bool with_reset);

  /// Takes bytes off the front of `bytes`; what is left when it is done is the stream's.
  void receive(std::span<const std::byte>& bytes, std::int64_t now_ns, LrfSink& sink);
  void on_deadline(std::int64_t now_ns, LrfSink& sink);
  [[nodiscard]] int line_baud() const { return rate_.baud(); }

 private:
  void listen(std::int64_t now_ns);

  RateSearch rate_;
  PacketListener<PacketReader> listener_;
};

}  // namespace odoless::ldrobot
