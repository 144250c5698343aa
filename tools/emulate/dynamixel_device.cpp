#include "tools/emulate/dynamixel_device.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/base/check.hpp"
#include "drivers/tilt/dynamixel/control_table.hpp"

namespace odoless {
namespace {

constexpr std::int64_t kTickNs = 1'000'000;
constexpr std::int64_t kRebootNs = 300'000'000;
constexpr double kFastRadps = 30.0;  ///< without a profile
constexpr double kFastRadps2 = 600.0;
constexpr double kFarCounts = 1e9;  ///< further than it ever comes

constexpr std::array<int, 8> kBauds{9600, 57600, 115200, 1'000'000, 2'000'000, 3'000'000, 4'000'000, 4'500'000};
constexpr std::uint8_t kWatchdogTripped = 0xFF;
constexpr std::uint16_t kFirstGoal = 100;

const DynamixelModel& model_of(std::string_view name) {
  const DynamixelModel* const model = find_dynamixel_model(name);
  ODOLESS_CHECK(model != nullptr);
  return *model;
}

}  // namespace

DynamixelDevice::DynamixelDevice(DynamixelDeviceOptions options, std::int64_t now_ns)
    : options_(std::move(options)),
      time_(options_.faults, now_ns),
      table_(model_of(options_.model)),
      motor_(layout().centre_counts + options_.start_rad * counts_per_rad()),
      last_tick_ns_(now_ns) {
  table_.set(DynamixelTable::kId, static_cast<std::uint32_t>(options_.id), 1);
  table_.set(dynamixel::kOperatingMode, options_.mode, 1);
  power_up(now_ns);
  time_.start_until(now_ns);
}

void DynamixelDevice::power_up(std::int64_t now_ns) {
  table_.power_up();
  table_.set(dynamixel::kStatusReturnLevel, options_.answers, 1);
  motor_.halt();
  reader_.clear();
  answers_.clear();
  registered_.clear();
  now_s_ = heard_s_ = 0.0;
  time_.start_until(now_ns + kRebootNs);
}

double DynamixelDevice::counts_per_rad() const { return layout().counts_per_turn / (2.0 * std::numbers::pi); }

double DynamixelDevice::angle_rad() const {
  return (motor_.position_counts() - layout().centre_counts) / counts_per_rad();
}

double DynamixelDevice::velocity_radps() const { return motor_.velocity_counts_per_s() / counts_per_rad(); }

int DynamixelDevice::level() const { return static_cast<int>(table_.get(dynamixel::kStatusReturnLevel, 1)); }

bool DynamixelDevice::has_torque() const { return table_.get(dynamixel::kTorqueEnable, 1) != 0; }

int DynamixelDevice::baud() const { return kBauds.at(table_.get(DynamixelTable::kBaud, 1)); }

// A rate that no Dynamixel has is that of a terminal which nobody has set.
bool DynamixelDevice::line_is_right() const {
  return std::ranges::find(kBauds, line_baud_) == kBauds.end() || line_baud_ == baud();
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
  if (time_.is_silent(now_ns) || !line_is_right()) {
    return;
  }
  for (auto outcome = reader_.take(bytes); outcome != dynamixel::PacketReader::Outcome::kMore;
       outcome = reader_.take(bytes)) {
    if (outcome == dynamixel::PacketReader::Outcome::kPacket) {
      execute(reader_.packet(), now_ns);
    }
  }
}

DynamixelError DynamixelDevice::write(std::span<const std::uint8_t> address_and_data) {
  if (address_and_data.size() < 3) {
    return DynamixelError::kDataLength;
  }
  const auto first = static_cast<std::uint16_t>(address_and_data[0] + 256 * address_and_data[1]);
  const std::span<const std::uint8_t> data = address_and_data.subspan(2);
  const auto meets = [&](std::uint16_t begin, std::uint16_t end) {
    return first < layout().address(end) && first + static_cast<int>(data.size()) > layout().address(begin);
  };
  const bool has_goal =
      meets(kFirstGoal, dynamixel::kProfile) || meets(dynamixel::kGoalPosition, dynamixel::kRealtimeTick);
  if (has_goal && table_.get(dynamixel::kBusWatchdog, 1) == kWatchdogTripped) {
    return DynamixelError::kDataRange;
  }
  if (const DynamixelError problem = table_.problem(first, data); problem != DynamixelError::kNone) {
    return problem;
  }
  const bool had_torque = has_torque();
  const std::vector<std::uint16_t> addresses = table_.write(first, data);
  const bool is_kept = std::ranges::any_of(addresses, [&](auto at) { return !table_.is_lost(at); });
  kept_writes_ += is_kept ? 1 : 0;
  if (has_torque() != had_torque) {
    motor_.halt();
    table_.set(dynamixel::kGoalPosition, static_cast<std::uint32_t>(std::lround(motor_.position_counts())), 4);
  }
  on_written(addresses);
  return DynamixelError::kNone;
}

void DynamixelDevice::on_written(std::span<const std::uint16_t> addresses) {
  const auto has = [&](std::uint16_t address) {
    return std::ranges::find(addresses, layout().address(address)) != addresses.end();
  };
  const bool moves = has(dynamixel::kGoalPosition) || has(DynamixelTable::kGoalVelocity);
  if (moves && has_torque()) {
    follow_goal();
  }
}

void DynamixelDevice::follow_goal() {
  const double slope_counts_per_s2 =
      table_.get(dynamixel::kProfile, 4) * layout().acceleration_unit_radps2 * counts_per_rad();
  const double speed_counts_per_s =
      table_.get(dynamixel::kProfile + 4, 4) * layout().speed_unit_radps * counts_per_rad();
  const double slope = slope_counts_per_s2 == 0.0 ? kFastRadps2 * counts_per_rad() : slope_counts_per_s2;
  const std::uint32_t mode = table_.get(dynamixel::kOperatingMode, 1);
  if (mode == dynamixel::kPositionControl || mode == DynamixelTable::kExtendedPositionMode) {
    motor_.set_profile(speed_counts_per_s == 0.0 ? kFastRadps * counts_per_rad() : speed_counts_per_s, slope);
    motor_.go_to(table_.get_signed(dynamixel::kGoalPosition) + options_.sag_counts);
  } else if (mode == DynamixelTable::kVelocityMode) {
    const double wished =
        table_.get_signed(DynamixelTable::kGoalVelocity) * layout().speed_unit_radps * counts_per_rad();
    motor_.set_profile(std::abs(wished), slope);
    if (wished == 0.0) {
      motor_.stop(slope);
    } else {
      motor_.go_to(std::copysign(kFarCounts, wished));
    }
  }
}

DynamixelError DynamixelDevice::register_write(std::span<const std::uint8_t> address_and_data) {
  if (address_and_data.size() < 3) {
    return DynamixelError::kDataLength;
  }
  const auto first = static_cast<std::uint16_t>(address_and_data[0] + 256 * address_and_data[1]);
  const DynamixelError problem = table_.problem(first, address_and_data.subspan(2));
  if (problem == DynamixelError::kNone) {
    registered_.assign(address_and_data.begin(), address_and_data.end());
    table_.set(DynamixelTable::kRegistered, 1, 1);
  }
  return problem;
}

DynamixelError DynamixelDevice::do_registered() {
  table_.set(DynamixelTable::kRegistered, 0, 1);
  const std::vector<std::uint8_t> wished = std::exchange(registered_, {});
  return wished.empty() ? DynamixelError::kNone : write(wished);
}

/// Of the turns that it has made, which only the extended mode counts: the position within one turn stays.
DynamixelError DynamixelDevice::clear(std::span<const std::uint8_t> parameters) {
  constexpr std::array<std::uint8_t, 5> kTurns{0x01, 0x44, 0x58, 0x4C, 0x22};
  if (!std::ranges::equal(parameters, kTurns)) {
    return DynamixelError::kDataRange;
  }
  if (motor_.velocity_counts_per_s() != 0.0) {
    return DynamixelError::kResultFail;
  }
  const double turns = std::floor(motor_.position_counts() / layout().counts_per_turn);
  motor_.rename(motor_.position_counts() - turns * layout().counts_per_turn);
  return DynamixelError::kNone;
}

bool DynamixelDevice::factory_reset(std::uint8_t what, bool to_all) {
  constexpr std::uint8_t kAll = 0xFF;
  constexpr std::uint8_t kAllButId = 0x01;
  constexpr std::uint8_t kAllButIdAndBaud = 0x02;
  const bool is_known = what == kAll || what == kAllButId || what == kAllButIdAndBaud;
  if (!is_known || (what == kAll && to_all)) {  // or all would have one id
    return false;
  }
  const auto old_id = static_cast<std::uint32_t>(id());
  const std::uint32_t old_baud = table_.get(DynamixelTable::kBaud, 1);
  table_ = DynamixelTable(table_.model());
  if (what != kAll) {
    table_.set(DynamixelTable::kId, old_id, 1);
  }
  if (what == kAllButIdAndBaud) {
    table_.set(DynamixelTable::kBaud, old_baud, 1);
  }
  return true;
}

void DynamixelDevice::follow_faults(std::int64_t now_ns) {
  motor_.set_jammed(time_.fault(FaultKind::kStall, now_ns) != nullptr);
  if (const Fault* const error = time_.fault(FaultKind::kError, now_ns); error != nullptr) {
    table_.set(dynamixel::kHardwareError, static_cast<std::uint32_t>(error->value), 1);
    table_.set(dynamixel::kTorqueEnable, 0, 1);
    motor_.halt();
  }
  if (const Fault* const reboot = time_.reboot(now_ns); reboot != nullptr) {
    power_up(now_ns);
    time_.start_until(now_ns + (reboot->end_ns - reboot->start_ns));
  }
}

// Data sheet of the XL430-W250, "Bus Watchdog (98)".
void DynamixelDevice::follow_watchdog() {
  const std::uint32_t units = table_.get(dynamixel::kBusWatchdog, 1);
  if (units != 0 && units != kWatchdogTripped && has_torque() && now_s_ - heard_s_ > units * 0.02) {
    table_.set(dynamixel::kBusWatchdog, kWatchdogTripped, 1);
    motor_.stop(kFastRadps2 * counts_per_rad());
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
    motor_.push(options_.droop_radps * counts_per_rad() * elapsed_s);
  }
  answers_.send_due(now_ns, time_.is_silent(now_ns), output_);
}

std::int64_t DynamixelDevice::next_event_ns() const { return answers_.next_ns(last_tick_ns_ + kTickNs); }

std::vector<ServoFrame> DynamixelDevice::take_output() { return std::exchange(output_, {}); }

void DynamixelDevice::refresh() {
  const auto tick_ms = static_cast<std::int64_t>(now_s_ * 1000.0) % dynamixel::kTickWrapMs;
  const auto rounded = [](double value) {
    return static_cast<std::uint32_t>(static_cast<std::int32_t>(std::lround(value)));
  };
  table_.set(dynamixel::kRealtimeTick, static_cast<std::uint32_t>(tick_ms), 2);
  table_.set(dynamixel::kRealtimeTick + 2, motor_.velocity_counts_per_s() == 0.0 ? 0 : 1, 1);
  table_.set(dynamixel::kPresentVelocity, rounded(velocity_radps() / layout().speed_unit_radps), 4);
  table_.set(dynamixel::kPresentPosition, rounded(motor_.position_counts()), 4);
}

}  // namespace odoless
