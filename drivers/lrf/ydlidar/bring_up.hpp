#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "drivers/lrf/bring_up_steps.hpp"
#include "drivers/lrf/lrf_params.hpp"
#include "drivers/lrf/lrf_session.hpp"
#include "drivers/lrf/packet_listener.hpp"
#include "drivers/lrf/rate_search.hpp"
#include "drivers/lrf/ydlidar/packet.hpp"
#include "drivers/lrf/ydlidar/scan_stream.hpp"

namespace odoless::ydlidar {

enum class Step : std::uint8_t { kListen, kStart, kPause, kDone };

/// Some devices take no commands and stream as soon as they have power; the others must not be told anything while they
/// do. So it is listened to first, until some packets in a row make sense; where none come, the device is told to scan.
/// Where no rate of the line is set, at one rate after the other.
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
  void enter(Step step, std::int64_t now_ns);
  void look_for_answer(std::span<const std::byte> bytes, std::int64_t now_ns);

  RateSearch rate_;
  PacketListener<PacketReader> listener_;
  std::size_t matched_ = 0;  ///< bytes of the answer to the request
};

}  // namespace odoless::ydlidar
