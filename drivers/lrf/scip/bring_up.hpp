#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>

#include "drivers/lrf/lrf_params.hpp"
#include "drivers/lrf/lrf_session.hpp"
#include "drivers/lrf/scip/replies.hpp"
#include "drivers/lrf/scip/scan_stream.hpp"
#include "drivers/lrf/scip/time_query.hpp"

namespace odoless::scip {

/// The ritual that takes a device from any state to a stream of scans:
///
///   1. stop whatever runs (QT) and wait until the line is quiet;
///   2. QT again, for an answer: none: the next line rate, and anew; SCIP 1.1: switch to 2.0; time mode: leave it;
///   3. where a line rate is wished for and isn't there yet: SS;
///   4. PP: steps, ranges and rate are the device's;
///   5. TM0, TM1, TM2: the time of its clock, if it tells that;
///   6. MD, MS or ME: the stream.
///
/// Every answer that doesn't come or cannot be understood leads back to 1; a device that is broken is reset (RS). One
/// that answers in 2 again and again, and never gets farther, is told of once (LrfEventType::kUnanswered).
/// Thread: one thread. Real time: no allocation.
class BringUp {
 public:
  BringUp(const LrfParams& params, ScanStream& stream);

  /// From the first step. `with_reset`: the device is told to reset first.
  void start(std::int64_t now_ns, bool with_reset);

  [[nodiscard]] bool done() const { return step_ == Step::kDone; }
  /// Whether what is received now is to be thrown away.
  [[nodiscard]] bool ignores_bytes() const { return step_ == Step::kDrain || step_ == Step::kPause; }
  void on_ignored_bytes(std::int64_t now_ns);

  void on_reply(const Reply& reply, std::int64_t now_ns, LrfSink& sink);
  void on_deadline(std::int64_t now_ns, LrfSink& sink);
  [[nodiscard]] std::int64_t deadline_ns() const { return deadline_ns_; }

  /// What is to be sent; it counts as sent. Valid until the next call.
  [[nodiscard]] std::string_view take_request();
  [[nodiscard]] int line_baud() const { return line_baud_; }
  [[nodiscard]] std::uint64_t device_errors() const { return device_errors_; }

 private:
  enum class Step : std::uint8_t {
    kReset,
    kDrain,
    kProbe,
    kLeaveTimeMode,
    kSwitch,
    kSetRate,
    kAsk,
    kTime,
    kStart,
    kPause,
    kDone
  };

  void enter(Step step, std::int64_t now_ns);
  void pause(Errc reason, Status device_status, std::int64_t now_ns, LrfSink& sink);
  void send(std::string_view request);
  [[nodiscard]] std::string_view request_of(Step step);
  void on_probe(const Reply& reply, std::int64_t now_ns, LrfSink& sink);
  void on_parameters(const Reply& reply, std::int64_t now_ns, LrfSink& sink);
  void on_started(const Reply& reply, std::int64_t now_ns, LrfSink& sink);
  void on_time(const Reply& reply, std::int64_t now_ns);
  void on_rate(const Reply& reply, std::int64_t now_ns);
  void next_rate();

  LrfParams params_;
  ScanStream& stream_;
  TimeQuery time_;
  bool tells_no_time_ = false;  ///< it did not answer in this bring-up
  Step step_ = Step::kPause;
  std::int64_t deadline_ns_ = 0;
  std::int64_t drain_end_ns_ = 0;
  int line_baud_;
  int rates_tried_ = 0;
  bool rate_settled_ = false;  ///< the wished rate is there, or was refused
  bool silence_told_ = false;  ///< once per outage
  int probes_answered_ = 0;    ///< since the bring-up began
  bool reset_is_due_ = false;  ///< after the pause
  std::uint64_t device_errors_ = 0;
  std::array<char, 32> request_{};
  std::size_t request_size_ = 0;
};

}  // namespace odoless::scip
