#include "tools/emulate/cia402_device.hpp"

#include <algorithm>
#include <numbers>
#include <utility>

namespace odoless {
namespace {

using canopen::NmtCommand;
using canopen::NodeState;
using canopen::Object;
using cia402::PowerState;

constexpr std::int64_t kTickNs = 1'000'000;
constexpr std::uint32_t kIdMask = 0x7FF;
constexpr double kEncoderS = 4e-3;  // for which an encoder's counts make a velocity

/// Values of 6007h: what the drive does when its master is lost.
enum AbortOption : std::uint32_t { kNoAction, kFaultOption, kDisableVoltageOption, kQuickStopOption };

/// Values of 1029h, sub 1: what the node does then.
enum ErrorBehaviour : std::uint32_t { kToPreOperational, kNoChange, kToStopped };

}  // namespace

Cia402Device::Cia402Device(Cia402DeviceOptions options, std::int64_t now_ns)
    : options_(std::move(options)),
      time_(options_.faults, now_ns),
      dictionary_(options_.node),
      sdo_(options_.node),
      motor_(counts(options_.start_rad)),
      measured_from_counts_(motor_.position_counts()),
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
  sdo_.reset();
  pdos_.start();
  master_heard_s_ = -1.0;
  master_is_lost_ = false;
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

void Cia402Device::send(const std::optional<CanFrame>& frame) {
  if (frame) {
    send(*frame);
  }
}

void Cia402Device::receive(std::span<const std::byte> bytes, std::int64_t now_ns) {
  const std::optional<CanFrame> frame = to_can_frame(bytes);
  if (!frame || !frame->is_standard_data()) {
    return;
  }
  time_.start(now_ns);
  tick(now_ns);
  if (time_.is_silent(now_ns)) {
    return;
  }
  if (frame->id == canopen::kNmtCob) {
    on_nmt(*frame, now_ns);
  } else {
    on_frame(*frame);
  }
  damage_output(now_ns);
}

void Cia402Device::on_frame(const CanFrame& frame) {
  const std::uint32_t master = dictionary_.get({0x1016, 1}) >> 16U & 0x7FU;
  if (master != 0 && frame.id == canopen::kHeartbeatCob + master) {
    master_heard_s_ = now_s_;
    if (std::exchange(master_is_lost_, false) && power_ != PowerState::kFault) {
      send(errors_.clear());
    }
  } else if (node_state_ == NodeState::kStopped) {
    return;
  } else if (frame.id == canopen::kSdoRequestCob + static_cast<std::uint32_t>(options_.node)) {
    on_sdo(frame);
  } else if (node_state_ == NodeState::kOperational && frame.id == (dictionary_.get({0x1005, 0}) & kIdMask)) {
    on_sync();
  } else if (node_state_ == NodeState::kOperational) {
    on_received_pdo(frame);
  }
}

void Cia402Device::on_sdo(const CanFrame& frame) {
  std::optional<Object> written;
  refresh();
  send(sdo_.answer(frame, dictionary_, written));
  if (written) {
    on_write(*written);
  }
}

void Cia402Device::damage_output(std::int64_t now_ns) {
  if (time_.fault(FaultKind::kWrongSum, now_ns) == nullptr) {
    return;
  }
  for (ServoFrame& sent : output_) {
    CanFrame damaged = *to_can_frame(sent);
    damaged.size_bytes = static_cast<std::uint8_t>(std::max(0, damaged.size_bytes - 1));
    sent.assign(as_bytes(damaged).begin(), as_bytes(damaged).end());
  }
}

void Cia402Device::on_nmt(const CanFrame& frame, std::int64_t now_ns) {
  if (frame.size_bytes != 2 || (frame.data[1] != 0 && frame.data[1] != options_.node)) {
    return;
  }
  switch (static_cast<NmtCommand>(frame.data[0])) {
    case NmtCommand::kStart:
      if (std::exchange(node_state_, NodeState::kOperational) != NodeState::kOperational) {
        pdos_.start();
      }
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
  on_writes(pdos_.take_received());
  refresh();
  for (const CanFrame& frame : pdos_.at_sync()) {
    send(frame);
  }
}

void Cia402Device::on_received_pdo(const CanFrame& frame) {
  on_writes(pdos_.receive(frame));
  if (pdos_.was_too_short()) {
    send(errors_.raise(kPdoTooShort));
  }
}

void Cia402Device::on_writes(const std::vector<Object>& objects) {
  for (const Object& object : objects) {
    on_write(object);
  }
}

void Cia402Device::on_write(Object object) {
  if (object.index == 0x6040) {
    on_control_word(static_cast<std::uint16_t>(dictionary_.get(object)));
  } else if (object.index == 0x1017) {
    next_heartbeat_s_ = now_s_;
  } else if (object.index == 0x1003) {
    for (std::uint8_t sub = 1; sub <= 4; ++sub) {
      dictionary_.set({0x1003, sub}, 0);
    }
  } else if (object.index == 0x1016) {
    master_heard_s_ = -1.0;  // watched from the next heartbeat on
  } else if (object.index == 0x607A && is_cyclic() && power_ == PowerState::kEnabled) {
    follow_target();
  } else if (object.index == 0x6060) {
    homes_ = acknowledges_ = false;
  }
}

void Cia402Device::fail(std::uint16_t code) {
  dictionary_.set({0x603F, 0}, code);
  power_ = PowerState::kFault;
  motor_.halt();
  acknowledges_ = homes_ = false;
  send(errors_.raise(code));
}

void Cia402Device::follow_faults(std::int64_t now_ns) {
  motor_.set_jammed(time_.fault(FaultKind::kStall, now_ns) != nullptr);
  const Fault* const error = time_.fault(FaultKind::kError, now_ns);
  if (error != nullptr && !had_error_) {
    fail(static_cast<std::uint16_t>(error->value));
  }
  had_error_ = error != nullptr;
  if (const Fault* const reboot = time_.reboot(now_ns); reboot != nullptr) {
    time_.start_until(now_ns + (reboot->end_ns - reboot->start_ns));
    node_state_ = NodeState::kBootUp;
    motor_.halt();
  }
  if (node_state_ == NodeState::kBootUp && !time_.is_starting(now_ns)) {
    power_up(now_ns);
  }
}

void Cia402Device::follow_master() {
  const double timeout_s = (dictionary_.get({0x1016, 1}) & 0xFFFFU) * 1e-3;
  if (master_heard_s_ >= 0.0 && timeout_s > 0.0 && now_s_ - master_heard_s_ > timeout_s) {
    master_heard_s_ = -1.0;
    on_master_lost();
  }
}

void Cia402Device::on_master_lost() {
  master_is_lost_ = true;
  const std::uint32_t option = dictionary_.get({0x6007, 0});
  if (option == kFaultOption) {
    fail(kHeartbeatLost);
  } else {
    send(errors_.raise(kHeartbeatLost));
  }
  if (option == kQuickStopOption || option == kDisableVoltageOption) {
    on_control_word(option == kQuickStopOption ? cia402::kQuickStopControl : cia402::kDisableVoltage);
  }
  const std::uint32_t behaviour = dictionary_.get({0x1029, 1});
  if (behaviour == kToStopped) {
    node_state_ = NodeState::kStopped;
  } else if (behaviour == kToPreOperational && node_state_ == NodeState::kOperational) {
    node_state_ = NodeState::kPreOperational;
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
  measure_velocity();
  follow_master();
  if (node_state_ == NodeState::kOperational) {
    refresh();
    for (const CanFrame& frame : pdos_.at_time(now_s_)) {
      send(frame);
    }
  }
  const double period_s = dictionary_.get({0x1017, 0}) * 1e-3;
  if (period_s > 0.0 && now_s_ >= next_heartbeat_s_ && !time_.is_silent(now_ns)) {
    next_heartbeat_s_ = std::max(next_heartbeat_s_ + period_s, now_s_);
    send(canopen::heartbeat(options_.node, node_state_));
  }
  if (time_.is_silent(now_ns)) {
    output_.clear();
  }
}

void Cia402Device::measure_velocity() {
  const double axis_counts = motor_.position_counts() + zero_counts_;
  if (const double elapsed_s = now_s_ - measured_from_s_; elapsed_s >= kEncoderS) {
    measured_counts_per_s_ = (axis_counts - measured_from_counts_) / elapsed_s;
    measured_from_s_ = now_s_;
    measured_from_counts_ = axis_counts;
  }
}

std::int64_t Cia402Device::next_event_ns() const { return last_tick_ns_ + kTickNs; }

void Cia402Device::refresh() {
  dictionary_.set({0x6041, 0}, status_word());
  dictionary_.set({0x6061, 0}, dictionary_.get({0x6060, 0}));
  dictionary_.set({0x6064, 0}, static_cast<std::uint32_t>(static_cast<std::int32_t>(motor_.position_counts())));
  dictionary_.set({0x606C, 0}, static_cast<std::uint32_t>(static_cast<std::int32_t>(measured_counts_per_s_)));
}

}  // namespace odoless
