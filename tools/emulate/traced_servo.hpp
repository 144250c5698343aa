#pragma once

#include <memory>

#include "core/base/stamped_history.hpp"
#include "tools/emulate/emulated_servo.hpp"

namespace odoless {

/// An emulated servo that knows where its axis has been, for a laser that it tilts.
class TracedServo final : public EmulatedServo {
 public:
  explicit TracedServo(std::unique_ptr<EmulatedServo> servo);

  void receive(std::span<const std::byte> bytes, std::int64_t now_ns) override;
  void tick(std::int64_t now_ns) override;
  [[nodiscard]] std::int64_t next_event_ns() const override { return servo_->next_event_ns(); }
  [[nodiscard]] std::vector<ServoFrame> take_output() override { return servo_->take_output(); }
  void set_line_baud(int baud) override { servo_->set_line_baud(baud); }
  [[nodiscard]] double angle_rad() const override { return servo_->angle_rad(); }
  [[nodiscard]] double velocity_radps() const override { return servo_->velocity_radps(); }

  /// Where the axis was at a time of the last seconds; lets time pass until then where it has not yet.
  [[nodiscard]] double angle_rad_at(std::int64_t time_ns);

 private:
  void note(std::int64_t now_ns);

  static constexpr std::size_t kSamples = 4096;  // one a millisecond

  std::unique_ptr<EmulatedServo> servo_;
  StampedHistory<double, OnTheLine> angles_rad_;
};

}  // namespace odoless
