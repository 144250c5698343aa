#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "drivers/lrf/bring_up_steps.hpp"
#include "drivers/lrf/lrf_params.hpp"
#include "drivers/lrf/lrf_session.hpp"
#include "drivers/lrf/rate_search.hpp"
#include "drivers/lrf/rplidar/packet.hpp"
#include "drivers/lrf/rplidar/scan_stream.hpp"

namespace odoless::rplidar {

enum class Step : std::uint8_t {
  kReset,
  kStop,
  kAskInfo,
  kAskHealth,
  kAskUsualMode,
  kAskModeSample,
  kAskModeAnswer,
  kAskModeRange,
  kAskSampleTime,
  kAskSpeed,
  kMotor,
  kScan,
  kPause,
  kDone
};

/// The ritual that takes a device from any state to a stream of scans:
///
///   1. stop whatever stream runs and wait until the line is quiet;
///   2. ask what it is, which tells of its motor; no answer: the next line rate where none is set, and anew;
///   3. ask for its health; a device that is broken is reset;
///   4. ask which of its modes it recommends, where that is wished for, and how long a sample takes in it, how its
///      packets look and how far it sees; old firmware has no list of modes, and is asked for sample times alone;
///   5. turn the motor, where that takes a command, at the speed that the device tells;
///   6. start the scan; no answer: the device doesn't know it.
///
/// What a device that streamed has told in 4 and 5 holds as long as its answer in 2, which has its firmware and serial
/// number, is the same.
/// Thread: one thread. Real time: no allocation.
class BringUp final : public BringUpSteps<ScanStream, Step> {
 public:
  BringUp(const LrfParams& params, ScanStream& stream);

  /// From the first step. `with_reset`: the device is told to reset first.
  void start(std::int64_t now_ns, bool with_reset);

  /// Takes bytes off the front of `bytes`; what is left when it is done is the stream's.
  void receive(std::span<const std::byte>& bytes, std::int64_t now_ns, LrfSink& sink);
  void on_deadline(std::int64_t now_ns, LrfSink& sink);
  [[nodiscard]] int line_baud() const { return rate_.baud(); }

 private:
  static constexpr std::size_t kAnswerMaxBytes = 32;
  using Info = std::array<std::byte, 20>;  ///< model, firmware, hardware, serial number

  void enter(Step step, std::int64_t now_ns);
  [[nodiscard]] Request request_of(Step step) const;
  void on_answer(const Descriptor& descriptor, std::span<const std::byte> data, std::int64_t now_ns, LrfSink& sink);
  void on_info(std::span<const std::byte> data, std::int64_t now_ns);
  void on_setting(std::span<const std::byte> value, std::int64_t now_ns, LrfSink& sink);
  void on_sample_time(std::span<const std::byte> data);
  void on_stream(const Descriptor& descriptor, std::int64_t now_ns, LrfSink& sink);
  void ask_for_mode(std::int64_t now_ns);
  void ask_for_speed(std::int64_t now_ns);
  void turn_motor(std::int64_t now_ns);

  RateSearch rate_;
  Info info_{};
  int series_ = 0;  ///< the first digit of its model
  int mode_ = 0;    ///< by the device's list
  bool has_modes_ = false;
  bool told_all_ = false;     ///< what it was asked in 4 and 5
  bool is_known_ = false;     ///< what it told is still to hold
  bool is_standard_ = false;  ///< its scan comes in nodes
  ScanMode scan_mode_;
  int speed_rpm_ = 0;  ///< of the motor, as the device tells
  int duty_ = 0;
  std::array<std::byte, kAnswerMaxBytes> answer_{};
  std::size_t answer_size_ = 0;
  Request request_;
};

}  // namespace odoless::rplidar
