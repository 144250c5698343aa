#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "drivers/io/can_frame.hpp"
#include "drivers/tilt/angle_gate.hpp"
#include "drivers/tilt/cia402/drive.hpp"
#include "drivers/tilt/cia402/sdo_client.hpp"
#include "drivers/tilt/cia402/set_up.hpp"
#include "drivers/tilt/tilt_motion.hpp"
#include "drivers/tilt/tilt_ramp.hpp"
#include "drivers/tilt/tilt_session.hpp"

namespace odoless {

/// A CANopen drive in profile position or cyclic synchronous position mode (CiA 301, CiA 402-2):
///
///   1. pre-operational, and asked whether it is a drive (1000h);
///   2. set up by SDO (SetUp), and asked whether it has found its zero since its power-up (zero_mark), where it is to;
///   3. started; from now on a command and a SYNC per sample_period_ns, which both its PDOs answer;
///   4. where it has not: homing, after which the drive gets the mark;
///   5. switched on, and on its way.
///
/// A drive that stays silent, starts anew, leaves the operational state or cannot be switched on goes back to 1; one
/// that reports a fault or stalls is stopped and tried again after a pause. An angle bears the stamp of the SYNC at
/// which it was measured, as the bus's own echo tells, or as it was given out. Contract: see TiltSession.
class Cia402Session final : public TiltSession {
 public:
  explicit Cia402Session(const TiltParams& params);

  void reset(std::int64_t now_ns) override;
  void command(TiltCommand command, std::int64_t now_ns) override;
  void finish(TiltEnd end, std::int64_t now_ns) override;
  [[nodiscard]] bool is_finished() const override { return phase_ == Phase::kEnded; }
  void receive(std::span<const std::byte> bytes, std::int64_t arrival_ns, TiltSink& sink) override;
  [[nodiscard]] std::span<const std::byte> transmit() override;
  void tick(std::int64_t now_ns, TiltSink& sink) override;
  [[nodiscard]] std::int64_t next_deadline_ns() const override;
  [[nodiscard]] TiltState state() const override;
  [[nodiscard]] const TiltCounters& counters() const override { return counters_; }

 private:
  enum class Phase : std::uint8_t {
    kFind,
    kSetUp,
    kReadMark,
    kStart,
    kHomingMode,
    kHoming,
    kProfileMode,
    kWriteMark,
    kRun,
    kEnd,  ///< the last of those with a SYNC
    kPause,
    kEnded,
  };

  void send(const CanFrame& frame);
  void send_sdo();
  void enter(Phase phase, std::int64_t now_ns);
  void give_up(Errc reason, std::int64_t now_ns, TiltSink& sink);

  void on_bus_error(const CanFrame& frame, std::int64_t now_ns, TiltSink& sink);
  void on_emergency(const CanFrame& frame, std::int64_t now_ns, TiltSink& sink);
  void on_heartbeat(const CanFrame& frame, std::int64_t now_ns, TiltSink& sink);
  void on_sdo(canopen::SdoClient::Outcome outcome, std::int64_t now_ns, TiltSink& sink);
  void on_found(std::int64_t now_ns, TiltSink& sink);
  [[nodiscard]] bool tolerates() const;
  void next_setting(std::int64_t now_ns);
  void on_setting(bool was_refused, std::int64_t now_ns, TiltSink& sink);
  void on_status(const CanFrame& frame, std::int64_t arrival_ns, TiltSink& sink);
  void on_velocity(const CanFrame& frame, TiltSink& sink);
  void pass_on(double angle_rad, std::int64_t arrival_ns, TiltSink& sink);
  void follow_power(std::int64_t now_ns, TiltSink& sink);
  void start_fault(std::int64_t now_ns);

  void cycle(std::int64_t now_ns, TiltSink& sink);
  void watch(std::int64_t now_ns, TiltSink& sink);
  void advance(std::int64_t now_ns, TiltSink& sink);
  [[nodiscard]] bool is_cyclic() const { return phase_ >= Phase::kStart && phase_ <= Phase::kEnd; }
  [[nodiscard]] bool sends_heartbeat() const { return params_.master_id != 0 && phase_ != Phase::kEnded; }
  [[nodiscard]] cia402::Drive::Goal goal() const;
  /// Where the drive is to go in this cycle.
  [[nodiscard]] std::int32_t next_counts(std::int64_t now_ns);
  void on_end_written(bool is_done, std::int64_t now_ns);
  [[nodiscard]] bool is_left_as_wished() const;

  TiltParams params_;
  TiltScale scale_;
  cia402::SetUp set_up_;
  canopen::SdoClient sdo_;
  cia402::Drive drive_;
  TiltMotion motion_;
  TiltRamp ramp_;  ///< in cyclic mode
  AngleGate gate_;
  TiltCounters counters_;

  Phase phase_ = Phase::kPause;
  std::size_t setting_ = 0;  ///< the one that is being written
  bool has_heartbeat_ = true;
  std::int64_t phase_end_ns_ = 0;
  bool was_reset_ = false;
  bool silence_told_ = false;
  TiltEnd end_ = TiltEnd::kHold;  ///< in kEnd
  int failures_ = 0;              ///< bring-ups in a row
  bool homed_ = false;            ///< as the drive's mark tells
  bool ready_ = false;            ///< switched on once since the bring-up, or stopped as wished
  bool was_enabled_ = false;
  bool had_fault_ = false;
  bool in_fault_ = false;          ///< waits for `fault_end_ns_`
  std::int64_t fault_end_ns_ = 0;  ///< then of the time for its reset
  std::int64_t fault_pause_ns_ = 100'000'000;
  std::int64_t not_enabled_since_ns_ = 0;
  std::int64_t enabled_since_ns_ = 0;
  std::int64_t last_emergency_ns_ = 0;

  std::int64_t last_tick_ns_ = 0;
  std::int64_t next_sync_ns_ = 0;
  double angle_rad_ = 0.0;    ///< as measured last
  std::int64_t sync_ns_ = 0;  ///< of the last one
  std::int64_t next_heartbeat_ns_ = 0;
  std::int64_t heard_heartbeat_ns_ = 0;
  int unanswered_syncs_ = 0;
  std::int64_t last_stamp_ns_ = 0;
  double velocity_radps_ = 0.0;

  std::array<CanFrame, 16> outbox_{};
  std::size_t first_out_ = 0;
  std::size_t waiting_out_ = 0;
  CanFrame sent_;
};

}  // namespace odoless
