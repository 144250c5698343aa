#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

#include "drivers/lrf/lrf_params.hpp"
#include "drivers/lrf/lrf_session.hpp"

namespace odoless {

/// What the bring-ups of all protocols share: the step that they are at, until when it has time and what it sends, and
/// what they tell of a device that is silent, broken, or never comes to its stream.
///
/// `Step` has a kDone, and a kPause where a device may be refused: before it is asked again.
/// Thread: one thread. Real time: no allocation.
template <class Stream, class Step>
class BringUpSteps {
 public:
  [[nodiscard]] bool done() const { return step_ == Step::kDone; }
  [[nodiscard]] std::int64_t deadline_ns() const { return deadline_ns_; }
  /// What is to be sent; it counts as sent. Valid until the next call.
  [[nodiscard]] std::span<const std::byte> take_request() { return std::exchange(request_, {}); }
  /// How often the device has said that something is wrong with it.
  [[nodiscard]] std::uint64_t device_errors() const { return device_errors_; }

 protected:
  BringUpSteps(LrfParams params, Stream& stream) : params_(std::move(params)), stream_(stream) {}

  [[nodiscard]] const LrfParams& params() const { return params_; }
  [[nodiscard]] Stream& stream() const { return stream_; }
  [[nodiscard]] Step step() const { return step_; }

  /// The device does not stream (any more): what is told once may be told again.
  void begin() {
    silence_told_ = reset_is_due_ = false;
    answers_ = 0;
  }
  void wait(Step step, std::int64_t until_ns) {
    step_ = step;
    deadline_ns_ = until_ns;
    request_ = {};
  }
  void wait_longer(std::int64_t until_ns) { deadline_ns_ = std::max(deadline_ns_, until_ns); }
  /// It must stay as it is until it is taken.
  void send(std::span<const std::byte> request) { request_ = request; }
  /// Waits until the line is quiet, or is never.
  void drain(Step step, std::int64_t now_ns) {
    wait(step, now_ns + kQuietNs);
    drain_end_ns_ = now_ns + kDrainMaxNs;
  }
  /// A byte came meanwhile.
  void drain_on(std::int64_t now_ns) { deadline_ns_ = std::min(now_ns + kQuietNs, drain_end_ns_); }
  void finish() { wait(Step::kDone, deadline_ns_); }

  /// Nobody is there.
  void tell_silence(LrfSink& sink) {
    if (!std::exchange(silence_told_, true)) {
      sink.on_event({.type = LrfEventType::kLost, .reason = Errc::kDeviceSilent});
    }
  }
  /// It answers the first step. @param answers_max  On its way to the stream, at most.
  void count_answer(int answers_max, LrfSink& sink) {
    if (answers_++ == answers_max) {
      sink.on_event({.type = LrfEventType::kUnanswered, .reason = Errc::kDeviceSilent});
    }
  }
  void tell_error(int device_status, LrfSink& sink) {
    ++device_errors_;
    sink.on_event({.type = LrfEventType::kDeviceError, .reason = Errc::kDeviceStatus, .device_status = device_status});
  }

  /// It cannot be used as it is.
  void refuse(Errc reason, std::int64_t now_ns, LrfSink& sink) {
    sink.on_event({.type = LrfEventType::kRejected, .reason = reason});
    pause(now_ns);
  }
  /// It is broken.
  void fail(int device_status, std::int64_t now_ns, LrfSink& sink) {
    tell_error(device_status, sink);
    reset_is_due_ = true;
    pause(now_ns);
  }
  /// After the pause: whether it said that it was broken.
  [[nodiscard]] bool take_reset() { return std::exchange(reset_is_due_, false); }

 private:
  static constexpr std::int64_t kPauseNs = 1'000'000'000;
  static constexpr std::int64_t kQuietNs = 60'000'000;        ///< silence after which a line counts as drained
  static constexpr std::int64_t kDrainMaxNs = 1'000'000'000;  ///< then the next step is tried all the same

  void pause(std::int64_t now_ns) {
    answers_ = 0;  // why it does not stream is told
    wait(Step::kPause, now_ns + kPauseNs);
  }

  LrfParams params_;
  Stream& stream_;
  Step step_{};
  std::int64_t deadline_ns_ = 0;
  std::int64_t drain_end_ns_ = 0;
  std::span<const std::byte> request_;
  bool silence_told_ = false;
  int answers_ = 0;            ///< of the first step, since the bring-up began
  bool reset_is_due_ = false;  ///< after the pause
  std::uint64_t device_errors_ = 0;
};

}  // namespace odoless
