#pragma once

#include <optional>
#include <vector>

#include "drivers/tilt/dynamixel/packet.hpp"
#include "tools/emulate/dynamixel_table.hpp"
#include "tools/emulate/emulated_servo.hpp"
#include "tools/emulate/servo_motor.hpp"

namespace odoless {

struct DynamixelDeviceOptions {
  std::string_view model = "xm430-w350";
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

/// A Dynamixel, alone on its bus: every instruction of Protocol 2.0 but the backup's, to itself and to
/// all, on its control table; position and velocity control with profiles, torque, limits, memory that is kept and can
/// be written without torque only, watchdog of the bus, hardware errors. At a line rate other than its own it hears and
/// says nothing that makes sense.
class DynamixelDevice final : public EmulatedServo {
 public:
  DynamixelDevice(DynamixelDeviceOptions options, std::int64_t now_ns);

  void receive(std::span<const std::byte> bytes, std::int64_t now_ns) override;
  void tick(std::int64_t now_ns) override;
  [[nodiscard]] std::int64_t next_event_ns() const override;
  [[nodiscard]] std::vector<ServoFrame> take_output() override;
  [[nodiscard]] double angle_rad() const override;
  [[nodiscard]] double velocity_radps() const override;
  void set_line_baud(int baud) override { line_baud_ = baud; }

  /// What is in the control table, at an address of the X series.
  [[nodiscard]] std::uint32_t get(std::uint16_t address, int size_bytes) const {
    return table_.get(address, size_bytes);
  }
  /// Writes to memory that is kept, since construction.
  [[nodiscard]] int kept_writes() const { return kept_writes_; }
  /// Its rate on the line.
  [[nodiscard]] int baud() const;

 private:
  /// An instruction, and how it is to be answered.
  struct Asked {
    std::span<const std::uint8_t> parameters{};
    int id = 0;  ///< that it was sent to
    std::int64_t now_ns = 0;
  };

  void power_up(std::int64_t now_ns);
  void execute(const dynamixel::Packet& packet, std::int64_t now_ns);
  void execute_own(std::uint8_t instruction, const Asked& asked);
  void execute_common(std::uint8_t instruction, const Asked& asked);
  void read(const Asked& asked);
  /// Of several: whose place in the list it is, and all parameters before.
  void read_common(std::uint8_t instruction, const Asked& asked);
  void write_common(std::uint8_t instruction, const Asked& asked);
  [[nodiscard]] DynamixelError write(std::span<const std::uint8_t> address_and_data);
  [[nodiscard]] DynamixelError register_write(std::span<const std::uint8_t> address_and_data);
  [[nodiscard]] DynamixelError do_registered();
  [[nodiscard]] DynamixelError clear(std::span<const std::uint8_t> parameters);
  [[nodiscard]] bool factory_reset(std::uint8_t what, bool to_all);
  void on_written(std::span<const std::uint16_t> addresses);
  void follow_goal();
  /// By its status return level, and not to all.
  void acknowledge(DynamixelError error, const Asked& asked);
  void answer(int id, DynamixelError error, std::span<const std::uint8_t> data, std::int64_t due_ns);
  [[nodiscard]] std::uint8_t error_byte(DynamixelError error) const;
  [[nodiscard]] std::int64_t answer_due_ns(std::int64_t now_ns) const;
  void send_at(std::vector<std::uint8_t> packet, std::int64_t due_ns);
  void follow_faults(std::int64_t now_ns);
  void follow_watchdog();
  void refresh();
  [[nodiscard]] int id() const { return static_cast<int>(table_.get(DynamixelTable::kId, 1)); }
  [[nodiscard]] int level() const;
  [[nodiscard]] bool has_torque() const;
  [[nodiscard]] bool line_is_right() const;
  [[nodiscard]] const dynamixel::ControlTable& layout() const { return table_.model().layout; }
  [[nodiscard]] double counts_per_rad() const;

  DynamixelDeviceOptions options_;
  ServoTime time_;
  dynamixel::PacketReader reader_;
  DynamixelTable table_;
  ServoMotor motor_;
  std::vector<std::uint8_t> registered_;  ///< address and data
  ServoAnswers answers_;
  std::vector<ServoFrame> output_;
  int line_baud_ = 0;
  double now_s_ = 0.0;    ///< by its own clock, since power-up
  double heard_s_ = 0.0;  ///< of the last instruction
  int kept_writes_ = 0;
  std::int64_t last_tick_ns_ = 0;
};

}  // namespace odoless
