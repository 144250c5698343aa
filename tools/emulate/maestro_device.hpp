#pragma once

#include <array>
#include <vector>

#include "tools/emulate/emulated_servo.hpp"
#include "tools/emulate/servo_motor.hpp"

namespace odoless {

struct MaestroDeviceOptions {
  int channel = 0;
  int channels = 6;
  int device_number = 12;  ///< of the Pololu protocol
  double centre_us = 1500.0;
  double turn_us = 4000.0;
  bool is_on = false;  ///< sends pulses when it is switched on: its home position, at `start_rad`
  double start_rad = 0.2;
  double droop_radps = 0.0;  ///< how fast the axis sinks without pulses
  std::int64_t latency_ns = 300'000;
  std::vector<Fault> faults;  ///< silence, reboot, drift, error (bits of its errors)
};

/// A Pololu Maestro with one RC servo, by its User's Guide: the compact, the Pololu and the Mini SSC protocol (without
/// CRC), targets with speed and acceleration, positions, moving state, home, errors. A channel that was off goes to its
/// first target at once. The servo is where its pulse says.
class MaestroDevice final : public EmulatedServo {
 public:
  MaestroDevice(MaestroDeviceOptions options, std::int64_t now_ns);

  void receive(std::span<const std::byte> bytes, std::int64_t now_ns) override;
  void tick(std::int64_t now_ns) override;
  [[nodiscard]] std::int64_t next_event_ns() const override;
  [[nodiscard]] std::vector<ServoFrame> take_output() override;
  [[nodiscard]] double angle_rad() const override;
  [[nodiscard]] double velocity_radps() const override;

  [[nodiscard]] bool has_pulse() const { return has_pulse_; }
  [[nodiscard]] unsigned speed() const { return speed_; }
  [[nodiscard]] unsigned acceleration() const { return acceleration_; }
  [[nodiscard]] unsigned errors() const { return errors_; }

 private:
  void power_up(std::int64_t now_ns);
  void on_byte(unsigned byte);
  void execute(unsigned code, std::span<const unsigned> data);
  void execute_of_channel(unsigned code, unsigned number);
  void set_target(unsigned counts);
  void answer(std::initializer_list<unsigned> bytes);
  void follow_faults(std::int64_t now_ns);
  [[nodiscard]] double counts_per_rad() const;
  [[nodiscard]] double home_counts() const;

  MaestroDeviceOptions options_;
  ServoTime time_;
  ServoMotor motor_;
  std::vector<unsigned> received_;  ///< of the command that is being received
  ServoAnswers answers_;
  std::vector<ServoFrame> output_;
  bool has_pulse_ = false;
  unsigned speed_ = 0;  ///< 0: as fast as it can
  unsigned acceleration_ = 0;
  unsigned errors_ = 0;
  bool had_error_ = false;
  std::int64_t last_tick_ns_ = 0;
};

}  // namespace odoless
