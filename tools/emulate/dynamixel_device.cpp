#include "tools/emulate/dynamixel_device.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "drivers/tilt/dynamixel/control_table.hpp"

namespace odoless {
namespace {

using dynamixel::Instruction;
using dynamixel::Packet;

constexpr std::int64_t kTickNs = 1'000'000;
constexpr std::int64_t kRebootNs = 300'000'000;
constexpr std::uint16_t kFirstLost = 64;  ///< from here on the table is not kept
constexpr std::uint16_t kModel = 1020;    ///< XM430-W350
constexpr double kFastCounts = 20'000.0;  ///< without a profile, per second
constexpr double kFastSlope = 400'000.0;

constexpr std::uint8_t kInstructionError = 2;
constexpr std::uint8_t kRangeError = 4;
constexpr std::uint8_t kLengthError = 5;
constexpr std::uint8_t kLimitError = 6;
constexpr std::uint8_t kAccessError = 7;

constexpr std::uint8_t kWatchdogTripped = 0xFF;
constexpr double kCountsPerRad = dynamixel::kCountsPerTurn / (2.0 * std::numbers::pi);

}  // namespace

DynamixelDevice::DynamixelDevice(DynamixelDeviceOptions options, std::int64_t now_ns)
    : options_(std::move(options)),
      time_(options_.faults, now_ns),
      motor_(dynamixel::kCentreCounts + options_.start_rad * kCountsPerRad),
      last_tick_ns_(now_ns) {
  set(0, kModel, 2);
  set(6, 45, 1);
  set(7, static_cast<std::uint32_t>(options_.id), 1);
  set(dynamixel::kReturnDelay, 250, 1);
  set(dynamixel::kOperatingMode, options_.mode, 1);
  set(dynamixel::kPositionMax, 4095, 4);
  power_up(now_ns);
  silent_until_ns_ = now_ns;
}

void DynamixelDevice::power_up(std::int64_t now_ns) {
  std::fill(table_.begin() + kFirstLost, table_.end(), std::uint8_t{0});
  set(dynamixel::kStatusReturnLevel, options_.answers, 1);
  motor_.halt();
  reader_.clear();
  answers_.clear();
  now_s_ = 0.0;
  silent_until_ns_ = now_ns + kRebootNs;
}

std::uint32_t DynamixelDevice::get(std::uint16_t address, int size_bytes) const {
  std::uint32_t value = 0;
  for (int i = size_bytes - 1; i >= 0; --i) {
    value = value << 8U | table_.at(address + static_cast<unsigned>(i));
  }
  return value;
}

void DynamixelDevice::set(std::uint16_t address, std::uint32_t value, int size_bytes) {
  for (int i = 0; i < size_bytes; ++i, value >>= 8U) {
    table_.at(address + static_cast<unsigned>(i)) = static_cast<std::uint8_t>(value & 0xFFU);
  }
}

double DynamixelDevice::angle_rad() const {
  return (motor_.position_counts() - dynamixel::kCentreCounts) / kCountsPerRad;
}

double DynamixelDevice::velocity_radps() const { return motor_.velocity_counts_per_s() / kCountsPerRad; }

bool DynamixelDevice::has_torque() const { return get(dynamixel::kTorqueEnable, 1) != 0; }

bool DynamixelDevice::is_silent(std::int64_t now_ns) const {
  return now_ns < silent_until_ns_ || time_.fault(FaultKind::kSilence, now_ns) != nullptr;
}

void DynamixelDevice::receive(std::span<const std::byte> bytes, std::int64_t now_ns) {
  if (bytes.empty()) {
    return;
  }
  time_.start(now_ns);
  tick(now_ns);
  if (options_.echoes) {
    output_.emplace_back(bytes.begin(), bytes.end());
  }
  if (is_silent(now_ns)) {
    return;
  }
  for (auto outcome = reader_.take(bytes); outcome != dynamixel::PacketReader::Outcome::kMore;
       outcome = reader_.take(bytes)) {
    const Packet& packet = reader_.packet();
    if (outcome == dynamixel::PacketReader::Outcome::kPacket && packet.id == options_.id) {
      heard_s_ = now_s_;
      execute(packet, now_ns);
    }
  }
}

void DynamixelDevice::execute(const Packet& packet, std::int64_t now_ns) {
  const int level = table_[dynamixel::kStatusReturnLevel];
  switch (static_cast<Instruction>(packet.instruction)) {
    case Instruction::kPing: {
      const std::array<std::uint8_t, 3> model{table_[0], table_[1], table_[6]};
      return answer(0, model, now_ns);
    }
    case Instruction::kRead: {
      refresh();
      const auto first = static_cast<std::size_t>(packet.parameters[0] + 256 * packet.parameters[1]);
      const auto count = static_cast<std::size_t>(packet.parameters[2] + 256 * packet.parameters[3]);
      const bool fits = packet.size == 4 && count <= 100 && first + count <= table_.size();
      if (level >= 1) {
        answer(fits ? 0 : kRangeError, fits ? std::span(table_).subspan(first, count) : std::span<std::uint8_t>(),
               now_ns);
      }
      return;
    }
    case Instruction::kWrite: {
      const std::uint8_t error = write(packet);
      if (level >= 2) {
        answer(error, {}, now_ns);
      }
      return;
    }
    case Instruction::kReboot:
      answer(0, {}, now_ns);
      output_.push_back(std::move(answers_.back().bytes));
      power_up(now_ns);
      return;
    case Instruction::kStatus:
      return;
  }
  if (level >= 2) {
    answer(kInstructionError, {}, now_ns);
  }
}

std::uint8_t DynamixelDevice::write(const Packet& packet) {
  if (packet.size < 3) {
    return kLengthError;
  }
  const auto first = static_cast<std::uint16_t>(packet.parameters[0] + 256 * packet.parameters[1]);
  const auto count = static_cast<std::uint16_t>(packet.size - 2);
  if (first + count > static_cast<int>(table_.size()) || first >= dynamixel::kRealtimeTick) {
    return kRangeError;
  }
  if (first < kFirstLost && (has_torque() || first < 7)) {
    return kAccessError;
  }
  const bool has_goal = first <= dynamixel::kGoalPosition && first + count > dynamixel::kGoalPosition;
  if (has_goal && table_[dynamixel::kBusWatchdog] == kWatchdogTripped) {
    return kRangeError;
  }
  const std::array<std::uint8_t, 148> before = table_;
  std::copy_n(packet.parameters.begin() + 2, count, table_.begin() + first);
  const auto goal = static_cast<std::int32_t>(get(dynamixel::kGoalPosition, 4));
  const bool in_limits = goal >= static_cast<std::int32_t>(get(dynamixel::kPositionMin, 4)) &&
                         goal <= static_cast<std::int32_t>(get(dynamixel::kPositionMax, 4));
  if (has_goal && !in_limits) {
    table_ = before;
    return kLimitError;
  }
  kept_writes_ += first < kFirstLost ? 1 : 0;
  on_written(first, count);
  return 0;
}

void DynamixelDevice::on_written(std::uint16_t first, std::uint16_t count) {
  const auto has = [&](std::uint16_t address) { return first <= address && first + count > address; };
  if (has(dynamixel::kTorqueEnable)) {
    motor_.halt();
    set(dynamixel::kGoalPosition, static_cast<std::uint32_t>(std::lround(motor_.position_counts())), 4);
  }
  if (has(dynamixel::kGoalPosition) && has_torque() &&
      table_[dynamixel::kOperatingMode] == dynamixel::kPositionControl) {
    const double slope_counts_per_s2 = get(dynamixel::kProfile, 4) * dynamixel::kAccelerationUnitRadps2 * kCountsPerRad;
    const double speed_counts_per_s = get(dynamixel::kProfile + 4, 4) * dynamixel::kSpeedUnitRadps * kCountsPerRad;
    motor_.set_profile(speed_counts_per_s == 0.0 ? kFastCounts : speed_counts_per_s,
                       slope_counts_per_s2 == 0.0 ? kFastSlope : slope_counts_per_s2);
    motor_.go_to(static_cast<std::int32_t>(get(dynamixel::kGoalPosition, 4)) + options_.sag_counts);
  }
}

void DynamixelDevice::answer(std::uint8_t error, std::span<const std::uint8_t> data, std::int64_t now_ns) {
  std::vector<std::uint8_t> parameters{error};
  if (table_[dynamixel::kHardwareError] != 0) {
    parameters[0] |= dynamixel::kAlert;
  }
  parameters.insert(parameters.end(), data.begin(), data.end());
  dynamixel::PacketBytes packet = dynamixel::encode(options_.id, Instruction::kStatus, parameters);
  if (time_.fault(FaultKind::kWrongSum, now_ns) != nullptr) {
    packet.bytes[packet.size - 1] ^= 0x10U;
  }
  const std::span<const std::byte> bytes = std::as_bytes(packet.span());
  const std::int64_t delay_ns = options_.latency_ns + table_[dynamixel::kReturnDelay] * std::int64_t{2000};
  answers_.push_back({now_ns + delay_ns, {bytes.begin(), bytes.end()}});
}

void DynamixelDevice::follow_faults(std::int64_t now_ns) {
  motor_.set_jammed(time_.fault(FaultKind::kStall, now_ns) != nullptr);
  if (const Fault* const error = time_.fault(FaultKind::kError, now_ns); error != nullptr) {
    table_[dynamixel::kHardwareError] = static_cast<std::uint8_t>(error->value);
    table_[dynamixel::kTorqueEnable] = 0;
    motor_.halt();
  }
  const Fault* const reboot = time_.fault(FaultKind::kReboot, now_ns);
  if (reboot != nullptr && !was_rebooted_) {
    power_up(now_ns);
    silent_until_ns_ = now_ns + (reboot->end_ns - reboot->start_ns);
  }
  was_rebooted_ = reboot != nullptr;
}

// Data sheet of the XL430-W250, "Bus Watchdog (98)".
void DynamixelDevice::follow_watchdog() {
  const std::uint8_t units = table_[dynamixel::kBusWatchdog];
  if (units != 0 && units != kWatchdogTripped && has_torque() && now_s_ - heard_s_ > units * 0.02) {
    table_[dynamixel::kBusWatchdog] = kWatchdogTripped;
    motor_.stop(kFastSlope);
  }
}

void DynamixelDevice::tick(std::int64_t now_ns) {
  const double elapsed_s = time_.elapsed_s(now_ns);
  last_tick_ns_ = now_ns;
  now_s_ += elapsed_s;
  follow_faults(now_ns);
  follow_watchdog();
  motor_.advance(elapsed_s);
  if (!has_torque() && options_.droop_radps != 0.0) {
    motor_.push(options_.droop_radps * kCountsPerRad * elapsed_s);
  }
  while (!answers_.empty() && answers_.front().due_ns <= now_ns) {
    if (!is_silent(now_ns)) {
      output_.push_back(std::move(answers_.front().bytes));
    }
    answers_.pop_front();
  }
}

std::int64_t DynamixelDevice::next_event_ns() const {
  const std::int64_t next_ns = last_tick_ns_ + kTickNs;
  return answers_.empty() ? next_ns : std::min(next_ns, answers_.front().due_ns);
}

std::vector<ServoFrame> DynamixelDevice::take_output() { return std::exchange(output_, {}); }

void DynamixelDevice::refresh() {
  const auto tick_ms = static_cast<std::int64_t>(now_s_ * 1000.0) % dynamixel::kTickWrapMs;
  const double speed_units = velocity_radps() / dynamixel::kSpeedUnitRadps;
  set(dynamixel::kRealtimeTick, static_cast<std::uint32_t>(tick_ms), 2);
  set(dynamixel::kRealtimeTick + 2, motor_.is_there() ? 0 : 1, 1);
  set(dynamixel::kPresentVelocity, static_cast<std::uint32_t>(static_cast<std::int32_t>(std::lround(speed_units))), 4);
  set(dynamixel::kPresentPosition,
      static_cast<std::uint32_t>(static_cast<std::int32_t>(std::lround(motor_.position_counts()))), 4);
}

}  // namespace odoless
