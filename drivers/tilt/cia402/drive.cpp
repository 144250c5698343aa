#include "drivers/tilt/cia402/drive.hpp"

namespace odoless::cia402 {

void Drive::on_status(const DriveStatus& status) {
  status_ = status;
  power_ = power_state(status.status_word);
  if (!enabled()) {
    accepted_counts_.reset();
    offers_ = false;
  }
}

Drive::Output Drive::next(Goal goal, std::int32_t target_counts) {
  if (is_cyclic()) {
    forget_target();
    offers_ = false;
  }
  if (is_cyclic() || (goal == Goal::kMove && !offers_)) {
    target_counts_ = target_counts;
  }
  control_word_ = control(goal);
  homing_cycles_ = goal == Goal::kHome && enabled() ? homing_cycles_ + 1 : 0;
  return {.control_word = control_word_, .target_counts = target_counts_};
}

std::uint16_t Drive::control(Goal goal) {
  if (!power_) {
    return kQuickStopControl;  // holds a drive that is enabled, and enables none
  }
  if (goal == Goal::kStop || goal == Goal::kWait || goal == Goal::kRelease) {
    waiting_cycles_ = 0;
    offers_ = false;
    return goal == Goal::kRelease ? std::uint16_t{kDisableVoltage} : towards_stop(*power_);
  }
  // A drive may lack the way back from a quick stop (transition 16); then it goes through switch-on disabled.
  waiting_cycles_ = *power_ == PowerState::kQuickStop ? waiting_cycles_ + 1 : 0;
  if (waiting_cycles_ > kPatienceCycles) {
    return kDisableVoltage;
  }
  if (!enabled()) {
    return towards_enabled(*power_, control_word_);
  }
  if (is_cyclic()) {
    return kEnableOperation;
  }
  return kEnableOperation | (goal == Goal::kHome ? std::uint16_t{kNewSetPoint} : set_point_bits());
}

// The handshake of profile position mode (CiA 402-2, "set-point acknowledge"): the target is shown with bit 4 until the
// drive acknowledges it in bit 12; the next one may be shown once the drive has taken bit 12 back.
std::uint16_t Drive::set_point_bits() {
  if (offers_) {
    if (!acknowledged()) {
      return kNewSetPoint | kChangeAtOnce;
    }
    offers_ = false;
    accepted_counts_ = target_counts_;
    return 0;
  }
  if (accepted_counts_ == target_counts_ || acknowledged()) {
    return 0;
  }
  offers_ = true;
  return kNewSetPoint | kChangeAtOnce;
}

HomingState Drive::homing() const {
  if (homing_cycles_ < kHomingSettlesCycles) {
    return HomingState::kUnderWay;
  }
  if ((status_.status_word & kFollowingError) != 0) {  // in homing mode: the error
    return HomingState::kFailed;
  }
  constexpr std::uint16_t kDone = kSetPointAcknowledged | kTargetReached;
  return (status_.status_word & kDone) == kDone ? HomingState::kAttained : HomingState::kUnderWay;
}

}  // namespace odoless::cia402
