#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "drivers/lrf/lrf_params.hpp"
#include "drivers/lrf/lrf_session.hpp"
#include "drivers/lrf/rplidar/packet.hpp"
#include "drivers/lrf/rplidar/scan_stream.hpp"

namespace odoless::rplidar {

/// The ritual that takes a device from any state to a stream of scans:
///
///   1. stop whatever stream runs and wait until the line is quiet;
///   2. ask what it is, which tells of its motor; no answer: the next line rate where none is set, and anew;
///   3. ask for its health; a device that is broken is reset;
///   4. ask how long a sample takes; old firmware doesn't say;
///   5. the motor's duty, where it is wished for or the model needs it;
///   6. start the scan; no answer: the device doesn't know it.
///
/// Thread: one thread. Real time: no allocation.
class BringUp {
 public:
  BringUp(const LrfParams& params, ScanStream& stream);

  /// From the first step. `with_reset`: the device is told to reset first.
  void start(std::int64_t now_ns, bool with_reset);
  [[nodiscard]] bool done() const { return step_ == Step::kDone; }

  /// Takes bytes off the front of `bytes`; what is left when it is done is the stream's.
  void receive(std::span<const std::byte>& bytes, std::int64_t now_ns, LrfSink& sink);
  void on_deadline(std::int64_t now_ns, LrfSink& sink);
  [[nodiscard]] std::int64_t deadline_ns() const { return deadline_ns_; }

  /// What is to be sent; it counts as sent. Valid until the next call.
  [[nodiscard]] std::span<const std::byte> take_request();
  [[nodiscard]] int line_baud() const { return line_baud_; }
  [[nodiscard]] std::uint64_t device_errors() const { return device_errors_; }

 private:
  enum class Step : std::uint8_t { kReset, kStop, kAskInfo, kAskHealth, kAskSampleTime, kMotor, kScan, kPause, kDone };
  static constexpr std::size_t kAnswerMaxBytes = 32;

  void enter(Step step, std::int64_t now_ns);
  [[nodiscard]] Request request_of(Step step) const;
  void fail(Errc reason, int device_status, std::int64_t now_ns, LrfSink& sink);
  void on_answer(const Descriptor& descriptor, std::span<const std::byte> data, std::int64_t now_ns, LrfSink& sink);
  void on_sample_time(std::span<const std::byte> data);
  void start_stream(std::int64_t now_ns, LrfSink& sink);
  void tell_silence(LrfSink& sink);
  void next_rate();

  LrfParams params_;
  ScanStream& stream_;
  Step step_ = Step::kPause;
  Step silent_step_ = Step::kDone;  ///< that was told to be unanswered, which is told once; kDone: none
  std::int64_t deadline_ns_ = 0;
  std::int64_t drain_end_ns_ = 0;
  int line_baud_;
  int rates_tried_ = 0;
  std::int64_t sample_ns_ = 0;
  int motor_duty_ = 0;          ///< 0: none is sent
  bool rate_is_known_ = false;  ///< it cannot be changed, so it stays
  bool reset_is_due_ = false;   ///< after the pause
  std::uint64_t device_errors_ = 0;
  std::array<std::byte, kAnswerMaxBytes> answer_{};
  std::size_t answer_size_ = 0;
  Request request_;
  bool request_waits_ = false;
};

}  // namespace odoless::rplidar
