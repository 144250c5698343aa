#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "drivers/lrf/lrf_params.hpp"
#include "drivers/lrf/lrf_session.hpp"
#include "drivers/lrf/rate_search.hpp"
#include "drivers/lrf/ydlidar/packet.hpp"
#include "drivers/lrf/ydlidar/scan_stream.hpp"

namespace odoless::ydlidar {

/// Some devices take no commands and stream as soon as they have power; the others must not be told anything while they
/// do. So it is listened to first, until some packets in a row make sense; where none come, the device is told to scan.
/// Where no rate of the line is set, at one rate after the other.
///
/// Thread: one thread. Real time: no allocation.
class BringUp {
 public:
  BringUp(const LrfParams& params, ScanStream& stream);

  void start(std::int64_t now_ns, bool with_reset);
  [[nodiscard]] bool done() const { return step_ == Step::kDone; }

  /// Takes bytes off the front of `bytes`; what is left when it is done is the stream's.
  void receive(std::span<const std::byte>& bytes, std::int64_t now_ns, LrfSink& sink);
  void on_deadline(std::int64_t now_ns, LrfSink& sink);
  [[nodiscard]] std::int64_t deadline_ns() const { return deadline_ns_; }

  /// What is to be sent; it counts as sent.
  [[nodiscard]] std::span<const std::byte> take_request();
  [[nodiscard]] int line_baud() const { return rate_.baud(); }
  /// The device never says by itself that something is wrong with it.
  [[nodiscard]] static std::uint64_t device_errors() { return 0; }

 private:
  enum class Step : std::uint8_t { kListen, kStart, kRefused, kDone };

  void enter(Step step, std::int64_t now_ns);
  void look_for_answer(std::span<const std::byte> bytes, std::int64_t now_ns);
  void on_packet(std::int64_t now_ns, LrfSink& sink);

  LrfParams params_;
  ScanStream& stream_;
  RateSearch rate_;
  PacketReader reader_;
  Step step_ = Step::kListen;
  int packets_ = 0;          ///< that made sense, in a row
  std::size_t matched_ = 0;  ///< bytes of the answer to the request
  bool request_is_due_ = false;
  bool silence_told_ = false;
  std::int64_t deadline_ns_ = 0;
};

}  // namespace odoless::ydlidar
