#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "drivers/lrf/bring_up_steps.hpp"
#include "drivers/lrf/lrf_params.hpp"
#include "drivers/lrf/lrf_session.hpp"
#include "drivers/lrf/rate_search.hpp"
#include "drivers/lrf/sick/scan_stream.hpp"
#include "drivers/lrf/sick/telegram.hpp"

namespace odoless::sick {

constexpr int kPowerOn = 0x90;  ///< a device says by itself that it is on, also after a reset

/// What a device is set to.
struct Found {
  SickVariant variant = SickVariant::k180ByHalf;
  SickUnit unit = SickUnit::kMm;
  bool is_usual_mode = true;  ///< nothing would have to be written to its memory for that unit
};

enum class Step : std::uint8_t {
  kReset,
  kStop,
  kAskStatus,
  kAskConfiguration,
  kInstall,
  kConfigure,
  kLeaveInstallation,
  kSetVariant,
  kSetRate,
  kSettle,
  kStart,
  kPause,
  kDone
};

/// The ritual that takes a device from any state to a stream of scans:
///
///   1. end whatever stream runs; no answer: the next line rate, and anew;
///   2. ask for the status, which a device that is broken tells of;
///   3. ask for the configuration; where the unit of the ranges is another, switch to installation mode by the
///      password and write it (it goes to a memory that wears, hence not without need);
///   4. field of view and step;
///   5. where another line rate is wished for: switch the device and the line;
///   6. start the stream.
///
/// A line whose rate isn't ours to set (a serial device server's) keeps it, and so does the device.
/// Every answer that doesn't come or isn't understood leads back to 1; a device that is broken is reset. One that
/// answers in 1 again and again, and never gets farther, is told of once (LrfEventType::kUnanswered).
/// Thread: one thread. Real time: no allocation.
class BringUp final : public BringUpSteps<ScanStream, Step> {
 public:
  BringUp(const LrfParams& params, ScanStream& stream);

  /// From now on it ends with the answer of step 3, and leaves the device as `found` says, without a stream.
  void only_ask() { only_asks_ = true; }
  [[nodiscard]] const Found& found() const { return found_; }

  /// From the first step. `with_reset`: the device is told to reset first.
  void start(std::int64_t now_ns, bool with_reset);

  void on_telegram(const Telegram& telegram, std::int64_t now_ns, LrfSink& sink);
  /// The device has not understood.
  void on_nak(std::int64_t now_ns);
  void on_deadline(std::int64_t now_ns, LrfSink& sink);
  [[nodiscard]] int line_baud() const { return rate_.baud(); }

 private:
  static constexpr std::size_t kConfigurationBytes = 34;

  void enter(Step step, std::int64_t now_ns);
  void send_request_of(Step step);
  [[nodiscard]] std::int64_t patience_ns(Step step) const;
  [[nodiscard]] bool answers(const Telegram& telegram) const;
  void on_answer(const Telegram& telegram, std::int64_t now_ns, LrfSink& sink);
  void on_status(const Telegram& telegram, std::int64_t now_ns, LrfSink& sink);
  void on_configuration(const Telegram& telegram, std::int64_t now_ns, LrfSink& sink);
  void on_variant_set(std::int64_t now_ns, LrfSink& sink);

  bool only_asks_ = false;
  Found found_;
  SwitchedRate rate_;
  int naks_ = 0;
  int deaf_rounds_ = 0;        ///< in which the device was heard at this rate, but didn't answer
  bool heard_ = false;         ///< a telegram came at this rate since the stop was sent
  bool rate_refused_ = false;  ///< the device doesn't want the wished rate
  std::array<std::byte, kConfigurationBytes> configuration_{};
  Request request_;
};

}  // namespace odoless::sick
