#pragma once

#include <array>
#include <deque>

#include "drivers/tilt/dynamixel/packet.hpp"
#include "tools/emulate/emulated_servo.hpp"
#include "tools/emulate/servo_motor.hpp"

namespace odoless {

struct DynamixelDeviceOptions {
  int id = 1;
  double start_rad = 0.2;    ///< from its centre
  double sag_counts = 0.0;   ///< rests that far from its goal, as under a load
  double droop_radps = 0.0;  ///< how fast it sinks without torque
  bool echoes = false;       ///< the adapter sends back what it was sent, as half-duplex ones do
  std::uint8_t answers = 2;  ///< its status return level at power-up
  std::uint8_t mode = 1;     ///< operating mode at power-up: 1 velocity, 3 position
  std::int64_t latency_ns = 500'000;
  std::vector<Fault> faults;  ///< silence, wrong-sum, reboot, drift, stall, error (bits of the hardware error)
};

/// A Dynamixel of the X series: ping, read, write and reboot of Protocol 2.0 on its control table; position control
/// with profiles, torque, limits, memory that is kept and can be written without torque only, watchdog of the bus,
/// hardware errors.
class DynamixelDevice final : public EmulatedServo {
 public:
  DynamixelDevice(DynamixelDeviceOptions options, std::int64_t now_ns);

  void receive(std::span<const std::byte> bytes, std::int64_t now_ns) override;
  void tick(std::int64_t now_ns) override;
  [[nodiscard]] std::int64_t next_event_ns() const override;
  [[nodiscard]] std::vector<ServoFrame> take_output() override;
  [[nodiscard]] double angle_rad() const override;
  [[nodiscard]] double velocity_radps() const override;

  /// What is in the control table.
  [[nodiscard]] std::uint32_t get(std::uint16_t address, int size_bytes) const;
  /// Writes to memory that is kept, since construction.
  [[nodiscard]] int kept_writes() const { return kept_writes_; }

 private:
  struct Answer {
    std::int64_t due_ns = 0;
    ServoFrame bytes;
  };

  void power_up(std::int64_t now_ns);
  void set(std::uint16_t address, std::uint32_t value, int size_bytes);
  void execute(const dynamixel::Packet& packet, std::int64_t now_ns);
  [[nodiscard]] std::uint8_t write(const dynamixel::Packet& packet);
  void on_written(std::uint16_t first, std::uint16_t count);
  void answer(std::uint8_t error, std::span<const std::uint8_t> data, std::int64_t now_ns);
  void follow_faults(std::int64_t now_ns);
  void follow_watchdog();
  void refresh();
  [[nodiscard]] bool has_torque() const;
  [[nodiscard]] bool is_silent(std::int64_t now_ns) const;

  DynamixelDeviceOptions options_;
  ServoTime time_;
  dynamixel::PacketReader reader_;
  std::array<std::uint8_t, 148> table_{};
  ServoMotor motor_;
  std::deque<Answer> answers_;
  std::vector<ServoFrame> output_;
  double now_s_ = 0.0;    ///< by its own clock, since power-up
  double heard_s_ = 0.0;  ///< of the last instruction
  int kept_writes_ = 0;
  bool was_rebooted_ = false;
  std::int64_t last_tick_ns_ = 0;
  std::int64_t silent_until_ns_ = 0;
};

}  // namespace odoless
