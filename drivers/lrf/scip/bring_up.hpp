#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>

#include "drivers/lrf/bring_up_steps.hpp"
#include "drivers/lrf/lrf_params.hpp"
#include "drivers/lrf/lrf_session.hpp"
#include "drivers/lrf/rate_search.hpp"
#include "drivers/lrf/scip/replies.hpp"
#include "drivers/lrf/scip/scan_stream.hpp"
#include "drivers/lrf/scip/time_query.hpp"

namespace odoless::scip {

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
class BringUp final : public BringUpSteps<ScanStream, Step> {
 public:
  BringUp(const LrfParams& params, ScanStream& stream);

  /// From the first step. `with_reset`: the device is told to reset first.
  void start(std::int64_t now_ns, bool with_reset);

  /// Whether what is received now is to be thrown away.
  [[nodiscard]] bool ignores_bytes() const { return step() == Step::kDrain || step() == Step::kPause; }
  void on_ignored_bytes(std::int64_t now_ns);

  void on_reply(const Reply& reply, std::int64_t now_ns, LrfSink& sink);
  void on_deadline(std::int64_t now_ns, LrfSink& sink);
  [[nodiscard]] int line_baud() const { return rate_.baud(); }

 private:
  void enter(Step step, std::int64_t now_ns);
  [[nodiscard]] std::string_view request_of(Step step, std::int64_t now_ns);
  [[nodiscard]] std::string_view write_rate_request();
  void on_probe(const Reply& reply, std::int64_t now_ns, LrfSink& sink);
  void on_parameters(const Reply& reply, std::int64_t now_ns, LrfSink& sink);
  void on_started(const Reply& reply, std::int64_t now_ns, LrfSink& sink);
  void on_time(const Reply& reply, std::int64_t now_ns);
  void on_rate(const Reply& reply, std::int64_t now_ns);

  TimeQuery time_;
  bool tells_no_time_ = false;  ///< it did not answer in this bring-up
  SwitchedRate rate_;
  bool rate_settled_ = false;  ///< the wished rate is there, or was refused
  std::array<char, 9> rate_request_{'S', 'S', '0', '0', '0', '0', '0', '0', '\n'};
};

}  // namespace odoless::scip
