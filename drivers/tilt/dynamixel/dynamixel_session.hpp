#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "drivers/tilt/angle_gate.hpp"
#include "drivers/tilt/dynamixel/control_table.hpp"
#include "drivers/tilt/dynamixel/packet.hpp"
#include "drivers/tilt/tilt_motion.hpp"
#include "drivers/tilt/tilt_session.hpp"

namespace odoless {

/// A Dynamixel of the X or P series in position control mode, Protocol 2.0:
///
///   1. ping, which tells the model and so its control table; all instructions are to be answered;
///   2. a hardware error is told, and cleared by a reboot;
///   3. what is kept in the servo (return delay, mode, limits) is written only where it differs: that memory wears out;
///   4. goal = where it is, or the limit next to it, torque on, its own watchdog of the bus on;
///   5. one read of clock, speed and position per sample_period_ns; goals, and a look at its health, between them.
///
/// A servo that doesn't answer three times, or whose clock starts anew, goes back to 1; one that stalls is stopped
/// where it is and tried again after a pause. An angle bears the stamp of its answer's arrival less the time on the
/// line. Own packets that come back (half-duplex adapters) are known and dropped. Contract: see TiltSession.
class DynamixelSession final : public TiltSession {
 public:
  explicit DynamixelSession(const TiltParams& params);

  void reset(std::int64_t now_ns) override;
  void command(TiltCommand command, std::int64_t now_ns) override;
  void finish(TiltEnd end, std::int64_t now_ns) override;
  [[nodiscard]] bool is_finished() const override { return step_ == Step::kEnded; }
  void receive(std::span<const std::byte> bytes, std::int64_t arrival_ns, TiltSink& sink) override;
  [[nodiscard]] std::span<const std::byte> transmit() override;
  void tick(std::int64_t now_ns, TiltSink& sink) override;
  [[nodiscard]] std::int64_t next_deadline_ns() const override;
  [[nodiscard]] TiltState state() const override;
  [[nodiscard]] const TiltCounters& counters() const override { return counters_; }

 private:
  enum class Step : std::uint8_t {
    kPing,
    kAnswerAll,
    kCheckHealth,
    kReboot,
    kReadSettings,
    kTorqueOff,
    kReturnDelay,
    kMode,
    kLimits,
    kClearWatchdog,
    kFindPosition,
    kGoalHere,
    kTorqueOn,
    kWatchdog,
    kRun,  ///< the last of the bring-up: the steps from here on are done again and again
    kPollMotion,
    kPollHealth,
    kGoal,
    kPause,
    kEndGoal,
    kEndRelease,
    kEndWatchdog,
    kEnded,
  };

  void enter(Step step, std::int64_t now_ns);
  void ask(dynamixel::Instruction instruction, std::span<const std::uint8_t> parameters, std::size_t answer_bytes,
           std::int64_t now_ns);
  void use(const dynamixel::ControlTable& table);
  /// What the servo keeps at `address`, as it was read.
  [[nodiscard]] std::uint32_t setting(std::uint16_t address, std::size_t size_bytes) const;
  [[nodiscard]] std::uint32_t profile_max(std::uint16_t limit_address) const;
  void read(std::uint16_t address_in_x, std::uint16_t size_bytes, std::int64_t now_ns);
  void write(std::uint16_t address_in_x, std::span<const std::uint32_t> values, std::size_t value_bytes,
             std::int64_t now_ns);
  void write_goal(bool is_stop, std::int64_t now_ns);
  [[nodiscard]] std::int32_t wished_counts() const;
  [[nodiscard]] bool stops() const { return motion_.command() == TiltCommand::kStop || in_fault_; }
  [[nodiscard]] bool goal_is_due() const;

  void on_packet(std::int64_t arrival_ns, TiltSink& sink);
  void on_answer(const dynamixel::Packet& packet, std::int64_t arrival_ns, TiltSink& sink);
  void on_found(const dynamixel::Packet& packet, std::int64_t now_ns, TiltSink& sink);
  void on_settings(const dynamixel::Packet& packet, std::int64_t now_ns);
  void next_setting(std::int64_t now_ns);
  void on_motion(const dynamixel::Packet& packet, std::int64_t arrival_ns, TiltSink& sink);
  void on_health(const dynamixel::Packet& packet, std::int64_t now_ns, TiltSink& sink);
  void go_on(std::int64_t now_ns);
  void on_timeout(std::int64_t now_ns, TiltSink& sink);
  void watch(std::int64_t now_ns, TiltSink& sink);

  void begin_end(std::int64_t now_ns);
  void give_up(Errc reason, std::int64_t pause_ns, std::int64_t now_ns, TiltSink& sink);
  [[nodiscard]] bool runs() const { return step_ >= Step::kRun && step_ < Step::kPause; }

  TiltParams params_;
  dynamixel::ControlTable table_;  ///< of the model that answered the ping
  TiltScale scale_;
  std::int32_t low_counts_ = 0;  ///< its limits
  std::int32_t high_counts_ = 0;
  TiltMotion motion_;
  AngleGate gate_;
  dynamixel::PacketReader reader_;
  TiltCounters counters_;

  Step step_ = Step::kPause;
  bool was_reset_ = false;
  bool silence_told_ = false;
  bool ready_ = false;
  bool has_error_ = false;  ///< told one since it obeyed last
  bool reboot_is_due_ = false;
  bool health_is_due_ = false;
  bool in_fault_ = false;
  std::optional<TiltEnd> end_;  ///< it is to be left so
  bool has_run_ = false;        ///< when that was asked
  std::int64_t fault_end_ns_ = 0;
  std::int64_t fault_pause_ns_;
  std::int64_t pause_end_ns_ = 0;
  std::int64_t next_poll_ns_ = 0;
  int polls_ = 0;
  int tries_ = 0;  ///< without an answer, in a row

  dynamixel::PacketBytes request_;
  bool busy_ = false;
  bool to_be_sent_ = false;
  std::size_t answer_bytes_ = 0;
  std::uint16_t asked_address_ = 0;  ///< of what is read or written; 0: another instruction
  std::int64_t asked_ns_ = 0;

  std::array<std::uint8_t, dynamixel::kSettingsBytes> settings_{};  ///< as the servo has them
  std::int32_t position_counts_ = 0;
  std::optional<std::int32_t> goal_counts_;  ///< as the servo has it
  bool goal_is_stop_ = false;
  std::optional<std::uint32_t> tick_ms_;
  std::int64_t tick_arrival_ns_ = 0;
  std::int64_t last_stamp_ns_ = 0;
};

}  // namespace odoless
