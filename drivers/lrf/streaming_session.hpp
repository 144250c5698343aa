#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>

#include "drivers/io/device_address.hpp"
#include "drivers/lrf/lrf_params.hpp"
#include "drivers/lrf/lrf_session.hpp"

namespace odoless {

/// What the sessions of all protocols share: the bring-up until the device streams, the stream until it stalls or ends,
/// and the bring-up again.
///
/// `Stream` makes scans of what the protocol received; `BringUp`, which has BringUpSteps, leads the device to it.
template <class Stream, class BringUp>
class StreamingSession : public LrfSession {
 public:
  void reset(std::int64_t now_ns) final { start_over(now_ns, false); }

  [[nodiscard]] std::span<const std::byte> transmit() final { return bring_up_.take_request(); }

  [[nodiscard]] std::int64_t next_deadline_ns() const final {
    return ready() ? last_scan_ns_ + std::max(stall_timeout_ns_, 3 * geometry().period_ns) : bring_up_.deadline_ns();
  }

  void tick(std::int64_t now_ns, LrfSink& sink) final {
    if (now_ns < next_deadline_ns()) {
      return;
    }
    if (ready()) {
      sink.on_event({.type = LrfEventType::kLost, .reason = Errc::kDeviceSilent});
      start_over(now_ns, false);
    } else {
      bring_up_.on_deadline(now_ns, sink);
      forget_received();
    }
  }

  [[nodiscard]] int line_baud() const final { return sets_rate_ ? bring_up_.line_baud() : 0; }
  [[nodiscard]] bool ready() const final { return bring_up_.done(); }
  [[nodiscard]] const LrfGeometry& geometry() const final { return stream_.geometry(); }
  [[nodiscard]] const LrfCounters& counters() const final { return counters_; }

 protected:
  StreamingSession(const LrfParams& params, int beams_max)
      : stream_(params, beams_max),
        bring_up_(params, stream_),
        sets_rate_(is_serial(params.device)),
        stall_timeout_ns_(params.stall_timeout_ns) {}

  /// Forgets what was half received; no stream runs now.
  virtual void forget_received() = 0;

  void start_over(std::int64_t now_ns, bool with_reset) {
    counters_.restarts += was_reset_ ? 1 : 0;
    was_reset_ = true;
    forget_received();
    bring_up_.start(now_ns, with_reset);
  }

  /// The stream runs. @param first_scan_ns  Its first scan counts as late from then on, as after a scan.
  void on_ready(std::int64_t first_scan_ns, LrfSink& sink) {
    last_scan_ns_ = first_scan_ns;
    others_in_a_row_ = 0;
    sink.on_event({.type = LrfEventType::kReady});
  }

  void pass_on(const LrfScan& scan, LrfSink& sink) {
    ++counters_.scans;
    counters_.identical_run = stream_.identical_run();
    counters_.identical += counters_.identical_run > 0 ? 1 : 0;
    last_scan_ns_ = scan.arrival_ns;
    others_in_a_row_ = 0;
    sink.on_scan(scan);
  }

  /// Of a device that tells with each scan how it is to be read: where that stays another (kWrongCount), somebody has
  /// set it otherwise, and it is brought up anew.
  void refuse(Errc reason, std::int64_t now_ns, LrfSink& sink) {
    counters_.reject(reason, sink);
    others_in_a_row_ += reason == Errc::kWrongCount ? 1 : 0;
    if (others_in_a_row_ >= kOthersMax) {
      sink.on_event({.type = LrfEventType::kLost, .reason = reason});
      start_over(now_ns, false);
    }
  }

  /// What the device says is wrong with it while it streams.
  void tell_device_error(int device_status, LrfSink& sink) {
    ++stream_device_errors_;
    count_device_errors();
    sink.on_event({.type = LrfEventType::kDeviceError, .reason = Errc::kDeviceStatus, .device_status = device_status});
  }
  void count_device_errors() { counters_.device_errors = stream_device_errors_ + bring_up_.device_errors(); }

  [[nodiscard]] Stream& stream() { return stream_; }
  [[nodiscard]] BringUp& bring_up() { return bring_up_; }
  [[nodiscard]] LrfCounters& counts() { return counters_; }

 private:
  static constexpr int kOthersMax = 8;

  Stream stream_;
  BringUp bring_up_;
  LrfCounters counters_;
  bool sets_rate_;  ///< of the line; at the far end of a network it is the server's
  std::int64_t stall_timeout_ns_;
  std::int64_t last_scan_ns_ = 0;
  std::uint64_t stream_device_errors_ = 0;
  int others_in_a_row_ = 0;
  bool was_reset_ = false;
};

}  // namespace odoless
