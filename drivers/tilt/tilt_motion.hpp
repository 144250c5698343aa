#pragma once

#include <cstdint>

#include "drivers/tilt/tilt_params.hpp"
#include "drivers/tilt/tilt_session.hpp"

namespace odoless {

/// Where a servo is to go for what it was told, and whether it does: the part that all protocols share.
///
/// Thread: one thread. Real time: a few steps per call.
class TiltMotion {
 public:
  explicit TiltMotion(const TiltParams& params);

  void command(TiltCommand command, std::int64_t now_ns);
  [[nodiscard]] TiltCommand command() const { return command_; }

  /// The servo obeys from now on: what was before counts for no stall.
  void start(std::int64_t now_ns);

  /// A measured angle. A sweep that has come to its end turns round: `target_rad` is another one then.
  void on_angle(const TiltSample& sample);

  /// Angle to go to, within the limits; of no meaning for TiltCommand::kStop.
  [[nodiscard]] double target_rad() const;

  /// Whether the servo should move and has not for stall_timeout_ns, or longer where its speed and acceleration take
  /// it, or takes much longer to arrive than they allow.
  [[nodiscard]] bool is_stalled(std::int64_t now_ns) const;

  /// What the servo does, as far as the last angle tells: kMoving, kLevel, kSweeping or kStopped.
  [[nodiscard]] TiltState state() const;

 private:
  [[nodiscard]] bool is_there() const;
  void start_leg(std::int64_t now_ns);

  TiltParams params_;
  double end_rad_[2];  ///< of the sweep
  std::int64_t stall_timeout_ns_;
  TiltCommand command_;
  int heading_for_ = 1;  ///< which end
  bool has_angle_ = false;
  double angle_rad_ = 0.0;
  double moved_from_rad_ = 0.0;  ///< where it last was seen to have moved ...
  std::int64_t moved_ns_ = 0;    ///< ... and when
  std::int64_t leg_end_ns_ = 0;  ///< when it should have arrived
};

/// Between the angle that a servo tells of itself and the one from the level pose.
class TiltScale {
 public:
  TiltScale(const TiltParams& params, double counts_per_turn, double centre_counts);

  [[nodiscard]] double angle_rad(std::int32_t position_counts) const;
  [[nodiscard]] double velocity_radps(double counts_per_s) const;
  /// Rounded to whole counts, and not beyond what 32 bits hold.
  [[nodiscard]] std::int32_t position_counts(double angle_rad) const;
  /// Of a speed or an acceleration: without sign or zero.
  [[nodiscard]] double counts(double radians) const;

 private:
  double sign_;
  double level_angle_rad_;
  double counts_per_rad_;
  double centre_counts_;
};

}  // namespace odoless
