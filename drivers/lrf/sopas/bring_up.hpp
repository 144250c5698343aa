#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "drivers/lrf/bring_up_steps.hpp"
#include "drivers/lrf/lrf_params.hpp"
#include "drivers/lrf/lrf_session.hpp"
#include "drivers/lrf/sopas/scan_stream.hpp"
#include "drivers/lrf/sopas/telegram.hpp"

namespace odoless::sopas {

/// What `LrfEvent::device_status` is: the code of a refusal (sFA), or one of these and a code.
inline constexpr int kScanRefused = 100;   ///< the wished rate and step (mLMPsetscancfg)
inline constexpr int kDeviceStatus = 200;  ///< what a scan says of its device

enum class Step : std::uint8_t {
  kStop,
  kLogIn,
  kAskScan,
  kSetScan,
  kSetContent,
  kMeasure,
  kRun,
  kStart,
  kFirstScan,
  kPause,
  kDone
};

/// The ritual that takes a device from any state to a stream of scans:
///
///   1. stop whatever stream runs (sEN LMDscandata 0); no answer: the other dialect, and anew;
///   2. log in, as authorized client;
///   3. where a rate and step are wished for and the device has others (sRN LMPscancfg): mLMPsetscancfg;
///   4. what a scan is to hold: ranges of 16 bits, of every scan or one of so many (sWN LMDscandatacfg);
///   5. measure (sMN LMCstartmeas) and leave the log-in (sMN Run);
///   6. start the stream (sEN LMDscandata 1), and wait for two scans of one shape.
///
/// What a device refuses or does not know in 2, 4 and 5 it does without, as models do that need no log-in: what its
/// scans hold, they tell. An answer that does not come leads back to 1. Nothing is written to its memory (mEEwriteall).
/// Thread: one thread. Real time: no allocation.
class BringUp final : public BringUpSteps<ScanStream, Step> {
 public:
  BringUp(const LrfParams& params, ScanStream& stream);

  /// From the first step.
  void start(std::int64_t now_ns, bool with_reset);

  void on_telegram(const Telegram& telegram, std::int64_t now_ns, LrfSink& sink);
  void on_deadline(std::int64_t now_ns, LrfSink& sink);
  [[nodiscard]] int line_baud() const { return line_baud_; }

 private:
  void enter(Step step, std::int64_t now_ns);
  [[nodiscard]] static std::string_view head_of(Step step);
  void send_request_of(Step step);
  [[nodiscard]] bool answers(const Telegram& telegram) const;
  void on_answer(const Telegram& telegram, std::int64_t now_ns, LrfSink& sink);
  void on_scan_settings(const Telegram& telegram, std::int64_t now_ns);
  void on_scan_set(const Telegram& telegram, std::int64_t now_ns, LrfSink& sink);
  void on_content_set(const Telegram& telegram, LrfSink& sink);
  void on_scan(const Telegram& telegram, std::int64_t now_ns, LrfSink& sink);

  Dialect dialect_ = Dialect::kAscii;
  int line_baud_;
  int silences_ = 0;            ///< dialects in a row that nothing answered in
  int scans_per_telegram_ = 1;  ///< that it sends one of
  ScanShape shape_;             ///< of the first scan, until a second one agrees
  Request request_;
};

}  // namespace odoless::sopas
