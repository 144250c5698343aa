#include "tools/emulate/cia402_device.hpp"

#include <algorithm>
#include <numbers>
#include <utility>

#include "tools/emulate/cia402_pdo.hpp"

namespace odoless {
namespace {

using canopen::NmtCommand;
using canopen::NodeState;
using canopen::Object;
using cia402::PowerState;

constexpr std::int64_t kTickNs = 1'000'000;
constexpr std::uint16_t kVoltageEnabled = 1U << 4U;
constexpr std::uint16_t kRemote = 1U << 9U;
constexpr std::uint16_t kHeartbeatLost = 0x8130;
constexpr std::uint32_t kHomingMode = 6;
constexpr std::uint32_t kQuickStopOption = 3;  ///< of 6007h
constexpr int kPdos = 4;

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

Cia402Device::Cia402Device(Cia402DeviceOptions options, std::int64_t now_ns)
    : options_(std::move(options)),
      time_(options_.faults, now_ns),
      dictionary_(options_.node),
      motor_(counts(options_.start_rad)),
      last_tick_ns_(now_ns) {
  reset_communication(now_ns);
}

double Cia402Device::counts(double angle_rad) const {
  return angle_rad * options_.counts_per_turn / (2.0 * std::numbers::pi);
}

double Cia402Device::angle_rad() const {
  return motor_.position_counts() * 2.0 * std::numbers::pi / options_.counts_per_turn;
}

double Cia402Device::axis_rad() const {
  return (motor_.position_counts() + zero_counts_) * 2.0 * std::numbers::pi / options_.counts_per_turn;
}

double Cia402Device::velocity_radps() const {
  return motor_.velocity_counts_per_s() * 2.0 * std::numbers::pi / options_.counts_per_turn;
}

void Cia402Device::power_up(std::int64_t now_ns) {
  dictionary_ = ObjectDictionary(options_.node);
  motor_.halt();
  power_ = PowerState::kSwitchOnDisabled;
  control_word_ = 0;
  acknowledges_ = homes_ = false;
  if (!options_.keeps_zero) {
    set_zero_here();
  }
  reset_communication(now_ns);
}

// Zero, power stage and all that is of the drive's profile stay (CiA 301, 7.3.2.2.1).
void Cia402Device::reset_communication(std::int64_t now_ns) {
  dictionary_.reset_communication();
  master_heard_s_ = -1.0;
  node_state_ = NodeState::kPreOperational;
  last_tick_ns_ = now_ns;
  send(canopen::heartbeat(options_.node, NodeState::kBootUp));
}

void Cia402Device::set_zero_here() {
  zero_counts_ += motor_.position_counts();
  motor_.rename(0.0);
}

void Cia402Device::send(const CanFrame& frame) {
  const std::span<const std::byte> bytes = as_bytes(frame);
  output_.emplace_back(bytes.begin(), bytes.end());
}

std::vector<ServoFrame> Cia402Device::take_output() { return std::exchange(output_, {}); }

bool Cia402Device::has_torque() const { return power_ == PowerState::kEnabled || power_ == PowerState::kQuickStop; }

bool Cia402Device::is_silent(std::int64_t now_ns) const {
  return now_ns < silent_until_ns_ || time_.fault(FaultKind::kSilence, now_ns) != nullptr;
}

void Cia402Device::receive(std::span<const std::byte> bytes, std::int64_t now_ns) {
  const std::optional<CanFrame> frame = to_can_frame(bytes);
  if (!frame || !frame->is_standard_data()) {
    return;
  }
  time_.start(now_ns);
  tick(now_ns);
  if (is_silent(now_ns)) {
    return;
  }
  const auto node = static_cast<std::uint32_t>(options_.node);
  const std::uint32_t master = dictionary_.get({0x1016, 1}) >> 16U;
  if (frame->id == canopen::kNmtCob) {
    on_nmt(*frame, now_ns);
  } else if (master != 0 && frame->id == canopen::kHeartbeatCob + master) {
    master_heard_s_ = now_s_;
  } else if (node_state_ == NodeState::kStopped) {
    return;
  } else if (frame->id == canopen::kSdoRequestCob + node) {
    bool written = false;
    refresh();
    send(dictionary_.answer(*frame, written));
    if (written) {
      on_write({static_cast<std::uint16_t>(canopen::get(*frame, 1, 2)), frame->data[3]});
    }
  } else if (node_state_ == NodeState::kOperational && frame->id == canopen::kSyncCob) {
    on_sync();
  } else if (node_state_ == NodeState::kOperational) {
    for (int pdo = 0; pdo < kPdos; ++pdo) {
      on_received_pdo(*frame, pdo);
    }
  }
  if (time_.fault(FaultKind::kWrongSum, now_ns) != nullptr) {
    for (ServoFrame& sent : output_) {
      CanFrame damaged = *to_can_frame(sent);
      damaged.size_bytes = static_cast<std::uint8_t>(std::max(0, damaged.size_bytes - 1));
      sent.assign(as_bytes(damaged).begin(), as_bytes(damaged).end());
    }
  }
}

void Cia402Device::on_nmt(const CanFrame& frame, std::int64_t now_ns) {
  if (frame.size_bytes != 2 || (frame.data[1] != 0 && frame.data[1] != options_.node)) {
    return;
  }
  switch (static_cast<NmtCommand>(frame.data[0])) {
    case NmtCommand::kStart:
      node_state_ = NodeState::kOperational;
      return;
    case NmtCommand::kStop:
      node_state_ = NodeState::kStopped;
      return;
    case NmtCommand::kPreOperational:
      node_state_ = NodeState::kPreOperational;
      return;
    case NmtCommand::kResetNode:
      power_up(now_ns);
      return;
    case NmtCommand::kResetCommunication:
      reset_communication(now_ns);
      return;
  }
}

void Cia402Device::on_sync() {
  refresh();
  for (int pdo = 0; pdo < kPdos; ++pdo) {
    send_pdo(pdo);
  }
}

void Cia402Device::send_pdo(int pdo) {
  if (const std::optional<CanFrame> frame = transmit_pdo(dictionary_, pdo)) {
    send(*frame);
  }
}

void Cia402Device::on_received_pdo(const CanFrame& frame, int pdo) {
  for (const Object& object : take_received_pdo(dictionary_, pdo, frame)) {
    on_write(object);
  }
}

void Cia402Device::on_write(Object object) {
  if (object.index == 0x6040) {
    on_control_word(static_cast<std::uint16_t>(dictionary_.get(object)));
  } else if (object.index == 0x1017) {
    next_heartbeat_s_ = now_s_;
  } else if (object.index == 0x6060) {
    homes_ = acknowledges_ = false;
  }
}

void Cia402Device::on_control_word(std::uint16_t control_word) {
  const std::uint16_t rising = control_word & ~control_word_;
  const bool bit4_rises = (rising & cia402::kNewSetPoint) != 0;
  const bool bit4_falls = (control_word_ & ~control_word & cia402::kNewSetPoint) != 0;
  if (power_ == PowerState::kFault && (rising & cia402::kFaultReset) != 0 && !had_error_) {
    power_ = PowerState::kSwitchOnDisabled;
    dictionary_.set({0x603F, 0}, 0);
  } else if (power_ != PowerState::kFault && power_ != PowerState::kFaultReaction) {
    switch_power(control_word);
  }
  if (power_ == PowerState::kEnabled && (bit4_rises || bit4_falls)) {
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

double Cia402Device::slope(std::uint16_t index) const {
  return dictionary_.get({index, static_cast<std::uint8_t>(index == 0x6099 ? 1 : 0)});
}

void Cia402Device::fail(std::uint16_t code) {
  dictionary_.set({0x603F, 0}, code);
  power_ = PowerState::kFault;
  motor_.halt();
  acknowledges_ = homes_ = false;
  send_emergency(code);
}

void Cia402Device::send_emergency(std::uint16_t code) {
  CanFrame emergency;
  emergency.id = canopen::kEmergencyCob + static_cast<std::uint32_t>(options_.node);
  emergency.size_bytes = 8;
  canopen::put(emergency, 0, code, 2);
  emergency.data[2] = 0x01;
  send(emergency);
}

void Cia402Device::follow_faults(std::int64_t now_ns) {
  motor_.set_jammed(time_.fault(FaultKind::kStall, now_ns) != nullptr);
  const Fault* const error = time_.fault(FaultKind::kError, now_ns);
  if (error != nullptr && !had_error_) {
    fail(static_cast<std::uint16_t>(error->value));
  }
  had_error_ = error != nullptr;
  const Fault* const reboot = time_.fault(FaultKind::kReboot, now_ns);
  if (reboot != nullptr && !was_rebooted_) {
    silent_until_ns_ = now_ns + (reboot->end_ns - reboot->start_ns);
    node_state_ = NodeState::kBootUp;
    motor_.halt();
  }
  was_rebooted_ = reboot != nullptr;
  if (node_state_ == NodeState::kBootUp && now_ns >= silent_until_ns_) {
    power_up(now_ns);
  }
}

void Cia402Device::follow_motion() {
  if (homes_ && !acknowledges_ && motor_.is_there()) {
    set_zero_here();
    acknowledges_ = true;
  }
  const bool stays = dictionary_.get({0x605A, 0}) >= 5;
  if (power_ == PowerState::kQuickStop && motor_.velocity_counts_per_s() == 0.0 && !stays) {
    power_ = PowerState::kSwitchOnDisabled;
  }
  const double timeout_s = (dictionary_.get({0x1016, 1}) & 0xFFFFU) * 1e-3;
  if (master_heard_s_ >= 0.0 && timeout_s > 0.0 && now_s_ - master_heard_s_ > timeout_s) {
    master_heard_s_ = -1.0;
    if (dictionary_.get({0x6007, 0}) != kQuickStopOption) {
      fail(kHeartbeatLost);
    } else {
      send_emergency(kHeartbeatLost);
      on_control_word(cia402::kQuickStopControl);
    }
  }
}

void Cia402Device::tick(std::int64_t now_ns) {
  const double elapsed_s = time_.elapsed_s(now_ns);
  last_tick_ns_ = now_ns;
  now_s_ += elapsed_s;
  follow_faults(now_ns);
  motor_.advance(elapsed_s);
  if (!has_torque() && options_.droop_radps != 0.0) {
    motor_.push(counts(options_.droop_radps) * elapsed_s);
  }
  follow_motion();
  const double period_s = dictionary_.get({0x1017, 0}) * 1e-3;
  if (period_s > 0.0 && now_s_ >= next_heartbeat_s_ && !is_silent(now_ns)) {
    next_heartbeat_s_ = std::max(next_heartbeat_s_ + period_s, now_s_);
    send(canopen::heartbeat(options_.node, node_state_));
  }
  if (is_silent(now_ns)) {
    output_.clear();
  }
}

std::int64_t Cia402Device::next_event_ns() const { return last_tick_ns_ + kTickNs; }

std::uint16_t Cia402Device::status_word() const {
  std::uint16_t word = state_bits(power_) | kVoltageEnabled | kRemote;
  const bool homing = dictionary_.get({0x6060, 0}) == kHomingMode;
  const bool reached = homing ? acknowledges_ || !homes_ : motor_.is_there();
  word |= acknowledges_ ? std::uint16_t{cia402::kSetPointAcknowledged} : std::uint16_t{0};
  word |= reached ? std::uint16_t{cia402::kTargetReached} : std::uint16_t{0};
  return word;
}

void Cia402Device::refresh() {
  dictionary_.set({0x6041, 0}, status_word());
  dictionary_.set({0x6061, 0}, dictionary_.get({0x6060, 0}));
  dictionary_.set({0x6064, 0}, static_cast<std::uint32_t>(static_cast<std::int32_t>(motor_.position_counts())));
  dictionary_.set({0x606C, 0}, static_cast<std::uint32_t>(static_cast<std::int32_t>(motor_.velocity_counts_per_s())));
}

}  // namespace odoless
