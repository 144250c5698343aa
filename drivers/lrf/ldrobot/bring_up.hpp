#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "drivers/lrf/ldrobot/packet.hpp"
#include "drivers/lrf/ldrobot/scan_stream.hpp"
#include "drivers/lrf/lrf_params.hpp"
#include "drivers/lrf/lrf_session.hpp"
#include "drivers/lrf/rate_search.hpp"

namespace odoless::ldrobot {

/// The device takes no commands and streams as soon as it has power. It is listened to until some packets in a row make
/// sense; where no rate of the line is set, at one rate after the other.
///
/// Thread: one thread. Real time: no allocation.
class BringUp {
 public:
  BringUp(const LrfParams& params, ScanStream& stream);

  void start(std::int64_t now_ns, bool with_reset);
  [[nodiscard]] bool done() const { return is_done_; }

  /// Takes bytes off the front of `bytes`; what is left when it is done is the stream's.
  void receive(std::span<const std::byte>& bytes, std::int64_t now_ns, LrfSink& sink);
  void on_deadline(std::int64_t now_ns, LrfSink& sink);
  [[nodiscard]] std::int64_t deadline_ns() const { return deadline_ns_; }

  [[nodiscard]] int line_baud() const { return rate_.baud(); }
  /// The device never says that something is wrong with it.
  [[nodiscard]] static std::uint64_t device_errors() { return 0; }

 private:
  void listen(std::int64_t now_ns);

  LrfParams params_;
  ScanStream& stream_;
  RateSearch rate_;
  PacketReader reader_;
  int packets_ = 0;  ///< that made sense, in a row
  bool is_done_ = false;
  bool is_refused_ = false;  ///< it waits until the deadline
  bool silence_told_ = false;
  std::int64_t deadline_ns_ = 0;
};

}  // namespace odoless::ldrobot
