#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/math/elementary.hpp"
#include "tools/emulate/cia402_device.hpp"

// What a drive does by its profile (CiA 402-2): power stage, set points, homing.
namespace odoless {
namespace {

using cia402::PowerState;

constexpr std::uint16_t kVoltageEnabled = 1U << 4U;
constexpr std::uint16_t kRemote = 1U << 9U;
constexpr std::uint32_t kHomingMode = 6;
constexpr std::uint32_t kCyclicPositionMode = 8;
constexpr double kFastSlope = 1e12;               ///< what it makes no ramp with
constexpr std::uint32_t kFirstStayingOption = 5;  ///< of 605Ah

std::uint16_t state_bits(PowerState state) {
  switch (state) {
    case PowerState::kNotReady:
      return 0x00;
    case PowerState::kSwitchOnDisabled:
      return 0x40;
    case PowerState::kReady:
      return 0x21;
    case PowerState::kSwitchedOn:
      return 0x23;
    case PowerState::kEnabled:
      return 0x27;
    case PowerState::kQuickStop:
      return 0x07;
    case PowerState::kFaultReaction:
      return 0x0F;
    case PowerState::kFault:
      return 0x08;
  }
  return 0;
}

}  // namespace

void Cia402Device::on_control_word(std::uint16_t control_word) {
  const std::uint16_t rising = control_word & ~control_word_;
  const bool bit4_rises = (rising & cia402::kNewSetPoint) != 0;
  const bool bit4_falls = (control_word_ & ~control_word & cia402::kNewSetPoint) != 0;
  if (power_ == PowerState::kFault && (rising & cia402::kFaultReset) != 0 && !had_error_) {
    power_ = PowerState::kSwitchOnDisabled;
    dictionary_.set({0x603F, 0}, 0);
    send(errors_.clear());
  } else if (power_ != PowerState::kFault && power_ != PowerState::kFaultReaction) {
    switch_power(control_word);
  }
  if (power_ == PowerState::kEnabled && !is_cyclic() && (bit4_rises || bit4_falls)) {
    on_set_point_bit(bit4_rises, control_word);
  }
  control_word_ = control_word;
}

// The transitions of CiA 402-2 by the command that a control word is.
void Cia402Device::switch_power(std::uint16_t control_word) {
  const bool voltage = (control_word & 0x02U) != 0;
  const bool no_quick_stop = (control_word & 0x04U) != 0;
  const PowerState before = power_;
  if (!voltage) {
    power_ = PowerState::kSwitchOnDisabled;
  } else if (!no_quick_stop) {
    const bool moves = before == PowerState::kEnabled || before == PowerState::kQuickStop;
    power_ = moves ? PowerState::kQuickStop : PowerState::kSwitchOnDisabled;
    if (before == PowerState::kEnabled) {
      motor_.stop(slope(0x6085));
    }
  } else if (before == PowerState::kQuickStop) {
    const bool resumes = options_.resumes_stop && (control_word & 0x0FU) == 0x0F;
    power_ = resumes ? PowerState::kEnabled : PowerState::kQuickStop;
  } else if ((control_word & 0x01U) == 0) {
    power_ = PowerState::kReady;
  } else if (before == PowerState::kReady) {
    power_ = PowerState::kSwitchedOn;
  } else if (before == PowerState::kSwitchedOn || before == PowerState::kEnabled) {
    power_ = (control_word & 0x08U) != 0 ? PowerState::kEnabled : PowerState::kSwitchedOn;
  }
  if (!has_torque()) {
    motor_.halt();
  }
  if (power_ != PowerState::kEnabled) {
    acknowledges_ = homes_ = false;
  }
}

void Cia402Device::on_set_point_bit(bool rises, std::uint16_t control_word) {
  const bool homing = dictionary_.get({0x6060, 0}) == kHomingMode;
  if (homing) {
    homes_ = rises;
    acknowledges_ = acknowledges_ && !rises;
    if (rises) {
      const std::int32_t method = dictionary_.get_signed({0x6098, 0});
      const bool homes_here = method == 35 || method == 37;
      motor_.set_profile(slope(0x6099), slope(0x609A));
      motor_.go_to(homes_here ? motor_.position_counts() : counts(options_.home_rad) - zero_counts_);
    }
    return;
  }
  acknowledges_ = rises;
  if (rises && ((control_word & cia402::kChangeAtOnce) != 0 || motor_.is_there())) {
    start_move();
  }
}

void Cia402Device::start_move() {
  const double wished = dictionary_.get_signed({0x607A, 0});
  const double low = dictionary_.get_signed({0x607D, 1});
  const double high = dictionary_.get_signed({0x607D, 2});
  motor_.set_profile(dictionary_.get({0x6081, 0}), slope(0x6083));
  motor_.go_to(std::clamp(wished, low, std::max(low, high)));
}

bool Cia402Device::is_cyclic() const { return dictionary_.get({0x6060, 0}) == kCyclicPositionMode; }

void Cia402Device::follow_target() {
  const double wished = dictionary_.get_signed({0x607A, 0});
  const double low = dictionary_.get_signed({0x607D, 1});
  const double high = dictionary_.get_signed({0x607D, 2});
  const double target = std::clamp(wished, low, std::max(low, high));
  const double time_s = dictionary_.get({0x60C2, 1}) *
                        math::exp(std::numbers::ln10 * static_cast<std::int8_t>(dictionary_.get({0x60C2, 2})));
  motor_.set_profile(std::abs(target - motor_.position_counts()) / std::max(time_s, 1e-4), kFastSlope);
  motor_.go_to(target);
}

double Cia402Device::slope(std::uint16_t index) const {
  return dictionary_.get({index, static_cast<std::uint8_t>(index == 0x6099 ? 1 : 0)});
}

void Cia402Device::follow_motion() {
  if (homes_ && !acknowledges_ && motor_.is_there()) {
    set_zero_here();
    acknowledges_ = true;
  }
  const bool stays = dictionary_.get({0x605A, 0}) >= kFirstStayingOption;
  if (power_ == PowerState::kQuickStop && motor_.velocity_counts_per_s() == 0.0 && !stays) {
    power_ = PowerState::kSwitchOnDisabled;
  }
}

std::uint16_t Cia402Device::status_word() const {
  std::uint16_t word = state_bits(power_) | kVoltageEnabled | kRemote;
  const bool homing = dictionary_.get({0x6060, 0}) == kHomingMode;
  const bool reached = homing ? acknowledges_ || !homes_ : motor_.is_there();
  word |= is_cyclic() && power_ == PowerState::kEnabled ? std::uint16_t{cia402::kSetPointAcknowledged}  // it follows
                                                        : std::uint16_t{0};
  word |= acknowledges_ ? std::uint16_t{cia402::kSetPointAcknowledged} : std::uint16_t{0};
  word |= reached ? std::uint16_t{cia402::kTargetReached} : std::uint16_t{0};
  return word;
}

}  // namespace odoless
