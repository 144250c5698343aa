#pragma once

#include <array>

#include "drivers/io/can_frame.hpp"
#include "drivers/tilt/cia402/power_state.hpp"
#include "tools/emulate/cia402_errors.hpp"
#include "tools/emulate/cia402_pdo.hpp"
#include "tools/emulate/emulated_servo.hpp"
#include "tools/emulate/sdo_server.hpp"
#include "tools/emulate/servo_motor.hpp"

namespace odoless {

struct Cia402DeviceOptions {
  int node = 1;
  double counts_per_turn = 65'536.0;
  double start_rad = 0.2;
  double droop_radps = 0.0;   ///< how fast it sinks without torque; 0: it has a brake
  bool keeps_zero = true;     ///< without power, as an absolute encoder does; else zero is where it is at power-up
  double home_rad = 0.0;      ///< where homing finds the zero; by the zero at first
  bool resumes_stop = true;   ///< has the way back from a quick stop (transition 16)
  std::vector<Fault> faults;  ///< silence, wrong-sum (frames too short), reboot, drift, stall, error (EMCY code)
};

/// A CANopen drive (CiA 301, 402): network management, heartbeats both ways, SDO server (expedited and by segments),
/// mapped PDOs at SYNC and at events, emergency messages, the power stage's states, profile position, cyclic position
/// and homing.
class Cia402Device final : public EmulatedServo {
 public:
  Cia402Device(Cia402DeviceOptions options, std::int64_t now_ns);

  void receive(std::span<const std::byte> bytes, std::int64_t now_ns) override;
  void tick(std::int64_t now_ns) override;
  [[nodiscard]] std::int64_t next_event_ns() const override;
  [[nodiscard]] std::vector<ServoFrame> take_output() override;
  [[nodiscard]] double angle_rad() const override;
  [[nodiscard]] double velocity_radps() const override;
  /// Where the axis truly is, by the zero at first.
  [[nodiscard]] double axis_rad() const;

  [[nodiscard]] cia402::PowerState power() const { return power_; }
  [[nodiscard]] canopen::NodeState node_state() const { return node_state_; }
  [[nodiscard]] const ObjectDictionary& dictionary() const { return dictionary_; }

 private:
  void power_up(std::int64_t now_ns);
  void reset_communication(std::int64_t now_ns);
  void set_zero_here();
  void send(const CanFrame& frame);
  void send(const std::optional<CanFrame>& frame);
  void on_nmt(const CanFrame& frame, std::int64_t now_ns);
  void on_frame(const CanFrame& frame);
  void on_sdo(const CanFrame& frame);
  void on_sync();
  void on_received_pdo(const CanFrame& frame);
  void on_writes(const std::vector<canopen::Object>& objects);
  void on_write(canopen::Object object);
  void on_control_word(std::uint16_t control_word);
  void switch_power(std::uint16_t control_word);
  void on_set_point_bit(bool rises, std::uint16_t control_word);
  void start_move();
  /// Cyclic position: to the target in the time that there is up to the next one.
  void follow_target();
  [[nodiscard]] bool is_cyclic() const;
  void fail(std::uint16_t code);
  void follow_faults(std::int64_t now_ns);
  void follow_motion();
  void measure_velocity();
  void follow_master();
  void on_master_lost();
  void damage_output(std::int64_t now_ns);
  void refresh();
  [[nodiscard]] bool has_torque() const;
  [[nodiscard]] std::uint16_t status_word() const;
  [[nodiscard]] double counts(double angle_rad) const;
  [[nodiscard]] double slope(std::uint16_t index) const;

  Cia402DeviceOptions options_;
  ServoTime time_;
  ObjectDictionary dictionary_;
  SdoServer sdo_;
  ProcessData pdos_{dictionary_};
  NodeErrors errors_{dictionary_};
  ServoMotor motor_;
  double measured_from_s_ = 0.0;  ///< the velocity that it tells, by its encoder: from when and where on
  double measured_from_counts_ = 0.0;
  double measured_counts_per_s_ = 0.0;
  double zero_counts_ = 0.0;  ///< where the zero is, by that at first
  std::vector<ServoFrame> output_;
  canopen::NodeState node_state_ = canopen::NodeState::kBootUp;
  cia402::PowerState power_ = cia402::PowerState::kSwitchOnDisabled;
  std::uint16_t control_word_ = 0;
  bool acknowledges_ = false;  ///< the set point, or that homing is attained
  bool homes_ = false;
  bool had_error_ = false;
  double now_s_ = 0.0;  ///< by its own clock, since power-up
  double next_heartbeat_s_ = 0.0;
  double master_heard_s_ = -1.0;  ///< negative: not yet, or not any more
  bool master_is_lost_ = false;
  std::int64_t last_tick_ns_ = 0;
};

}  // namespace odoless
