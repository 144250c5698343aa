#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/check.hpp"
#include "tests/support/servo_support.hpp"

namespace odoless::test {

/// What an owner of a TiltSession relies on.
class TiltOwner final : public TiltSink {
 public:
  void on_angle(const TiltSample& sample) override {
    ODOLESS_CHECK(sample.stamp_ns > last_stamp_ns_ && std::isfinite(sample.angle_rad));
    last_stamp_ns_ = sample.stamp_ns;
  }
  void on_event(const TiltEvent&) override {}

 private:
  std::int64_t last_stamp_ns_ = 0;
};

/// A session that obeys, brought up by an emulated servo: the input is the session's, not the servo's.
class FuzzedServo {
 public:
  explicit FuzzedServo(TiltDriver driver)
      : servo_(ServoBench::make_servo(servo_params(driver), {})), session_(make_tilt_session(servo_params(driver))) {
    session_->reset(now_ns_);
    for (int i = 0; i < 80 && session_->counters().samples == 0; ++i) {
      pass(kServoMs);
    }
    ODOLESS_CHECK(session_->counters().samples > 0);  // or nothing beyond the bring-up is tested
  }

  void pass(std::int64_t duration_ns) {
    now_ns_ += duration_ns;
    servo_->tick(now_ns_);
    exchange();
    session_->tick(now_ns_, owner_);
    ODOLESS_CHECK(session_->next_deadline_ns() > now_ns_);  // or its owner would spin
    exchange();
  }
  /// @param hears  Whether the servo's own answers come through from now on.
  void give(std::span<const std::uint8_t> bytes, bool hears) {
    hears_ = hears;
    session_->receive(std::as_bytes(bytes), now_ns_, owner_);
  }
  void command(unsigned number) { session_->command(static_cast<TiltCommand>(number % 3U), now_ns_); }

 private:
  void exchange() {
    constexpr int kFramesMax = 16;
    int frames = 0;
    for (const ServoFrame& frame : servo_->take_output()) {
      if (hears_) {
        session_->receive(frame, now_ns_, owner_);
      }
    }
    for (auto bytes = session_->transmit(); !bytes.empty(); bytes = session_->transmit()) {
      servo_->receive(bytes, now_ns_);
      ODOLESS_CHECK(++frames <= kFramesMax);
    }
  }

  std::unique_ptr<EmulatedServo> servo_;
  std::unique_ptr<TiltSession> session_;
  TiltOwner owner_;
  std::int64_t now_ns_ = 1000 * kServoSecond;
  bool hears_ = true;
};

/// A servo on a stream of bytes. Each piece of the input: how many milliseconds pass, how many bytes follow, what the
/// session is told and hears from then on; and the bytes.
inline void fuzz_stream(TiltDriver driver, const std::uint8_t* data, std::size_t size) {
  FuzzedServo servo(driver);
  std::size_t pieces = 0;
  for (std::size_t at = 0; at + 3 <= size && pieces < 200; ++pieces) {
    const std::size_t count = std::min<std::size_t>(data[at + 1], size - at - 3);
    servo.pass((1 + data[at] % 64) * kServoMs);
    servo.give({data + at + 3, count}, data[at + 2] % 8 != 0);
    servo.command(data[at + 2] / 8U);
    at += 3 + count;
  }
  for (int i = 0; i < 5; ++i) {
    servo.pass(10 * kServoMs);
  }
}

}  // namespace odoless::test
