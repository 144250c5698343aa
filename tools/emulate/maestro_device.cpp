#include "tools/emulate/maestro_device.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

namespace odoless {
namespace {

constexpr std::int64_t kTickNs = 1'000'000;
constexpr std::int64_t kRebootNs = 300'000'000;
constexpr double kCountsPerUs = 4.0;
constexpr double kFastCounts = 1e9;  ///< per second, of a channel without a limit
constexpr double kFastSlope = 1e12;
constexpr double kSpeedUnit = 100.0;
constexpr double kAccelerationUnit = 1250.0;
constexpr unsigned kProtocolError = 0x10;
constexpr unsigned kPololu = 0xAA;
constexpr unsigned kMiniSsc = 0xFF;
constexpr unsigned kFirstCommand = 0x80;

/// Data bytes of a command; nothing: there is no such command. That of 9Fh depends on its first byte.
std::optional<std::size_t> data_bytes(unsigned code, std::span<const unsigned> data) {
  switch (code) {
    case 0x84:
    case 0x87:
    case 0x89:
      return 3;
    case 0x90:
      return 1;
    case 0x93:
    case 0xA1:
    case 0xA2:
      return 0;
    case 0x9F:
      return data.empty() ? 2 : 2 + 2 * data[0];
    case kMiniSsc:
      return 2;
    default:
      return std::nullopt;
  }
}

}  // namespace

MaestroDevice::MaestroDevice(MaestroDeviceOptions options, std::int64_t now_ns)
    : options_(std::move(options)), time_(options_.faults, now_ns), motor_(home_counts()), last_tick_ns_(now_ns) {
  power_up(now_ns);
  time_.start_until(now_ns);
}

double MaestroDevice::counts_per_rad() const { return options_.turn_us * kCountsPerUs / (2.0 * std::numbers::pi); }

double MaestroDevice::home_counts() const {
  return options_.centre_us * kCountsPerUs + options_.start_rad * counts_per_rad();
}

void MaestroDevice::power_up(std::int64_t now_ns) {
  has_pulse_ = options_.is_on;
  speed_ = acceleration_ = errors_ = 0;
  received_.clear();
  answers_.clear();
  motor_.halt();
  time_.start_until(now_ns + kRebootNs);
}

double MaestroDevice::angle_rad() const {
  return (motor_.position_counts() - options_.centre_us * kCountsPerUs) / counts_per_rad();
}

double MaestroDevice::velocity_radps() const { return motor_.velocity_counts_per_s() / counts_per_rad(); }

void MaestroDevice::receive(std::span<const std::byte> bytes, std::int64_t now_ns) {
  if (bytes.empty()) {
    return;
  }
  time_.start(now_ns);
  tick(now_ns);
  if (time_.is_silent(now_ns)) {
    return;
  }
  for (const std::byte byte : bytes) {
    on_byte(std::to_integer<unsigned>(byte));
  }
}

// A byte with its highest bit begins a command, but in Mini SSC's, whose data may have it.
void MaestroDevice::on_byte(unsigned byte) {
  const bool is_mini_ssc = !received_.empty() && received_[0] == kMiniSsc;
  if (byte >= kFirstCommand && !is_mini_ssc) {
    errors_ |= received_.empty() ? 0U : kProtocolError;
    received_.clear();
  } else if (received_.empty()) {
    errors_ |= kProtocolError;
    return;
  }
  received_.push_back(byte);
  const bool is_pololu = received_[0] == kPololu;
  if (is_pololu && received_.size() < 3) {
    return;
  }
  const unsigned code = is_pololu ? received_[2] + kFirstCommand : received_[0];
  const auto data = std::span<const unsigned>(received_).subspan(is_pololu ? 3 : 1);
  const std::optional<std::size_t> wanted = data_bytes(code, data);
  if (!wanted) {
    errors_ |= kProtocolError;
    received_.clear();
  } else if (data.size() >= *wanted) {
    if (!is_pololu || received_[1] == static_cast<unsigned>(options_.device_number)) {
      execute(code, data);
    }
    received_.clear();
  }
}

void MaestroDevice::execute(unsigned code, std::span<const unsigned> data) {
  const auto channel = static_cast<unsigned>(options_.channel);
  switch (code) {
    case 0x93:
      return answer({has_pulse_ && !motor_.is_there() ? 1U : 0U});
    case 0xA1:
      return answer({errors_ & 0xFFU, std::exchange(errors_, 0U) >> 8U});
    case 0xA2:
      return set_target(options_.is_on ? static_cast<unsigned>(std::lround(home_counts())) : 0U);
    case 0x9F:
      if (data[1] <= channel && channel < data[1] + data[0]) {
        const std::size_t at = 2 + 2 * (channel - data[1]);
        set_target(data[at] | data[at + 1] << 7U);
      }
      return;
    case kMiniSsc:
      return data[0] == channel ? set_target(static_cast<unsigned>(std::lround(4000.0 + data[1] * 4000.0 / 254.0)))
                                : void();
    default:
      break;
  }
  if (data[0] >= static_cast<unsigned>(options_.channels)) {
    errors_ |= kProtocolError;
  } else if (data[0] == channel) {
    execute_of_channel(code, data.size() == 3 ? data[1] | data[2] << 7U : 0U);
  } else if (code == 0x90) {
    answer({0, 0});
  }
}

void MaestroDevice::execute_of_channel(unsigned code, unsigned number) {
  if (code == 0x84) {
    set_target(number);
  } else if (code == 0x87) {
    speed_ = number;
  } else if (code == 0x89) {
    acceleration_ = std::min(number, 255U);
  } else {
    const auto counts = has_pulse_ ? static_cast<unsigned>(std::lround(motor_.position_counts())) : 0U;
    answer({counts & 0xFFU, counts >> 8U});
  }
}

void MaestroDevice::set_target(unsigned counts) {
  if (counts == 0) {
    has_pulse_ = false;
    motor_.halt();
    return;
  }
  if (!std::exchange(has_pulse_, true) || (speed_ == 0 && acceleration_ == 0)) {
    motor_.rename(counts);
  }
  motor_.set_profile(speed_ == 0 ? kFastCounts : speed_ * kSpeedUnit,
                     acceleration_ == 0 ? kFastSlope : acceleration_ * kAccelerationUnit);
  motor_.go_to(counts);
}

void MaestroDevice::answer(std::initializer_list<unsigned> bytes) {
  ServoFrame frame;
  for (const unsigned byte : bytes) {
    frame.push_back(static_cast<std::byte>(byte));
  }
  answers_.add(std::move(frame), last_tick_ns_ + options_.latency_ns);
}

void MaestroDevice::follow_faults(std::int64_t now_ns) {
  const Fault* const error = time_.fault(FaultKind::kError, now_ns);
  if (error != nullptr && !had_error_) {
    errors_ |= static_cast<unsigned>(error->value);
  }
  had_error_ = error != nullptr;
  if (const Fault* const reboot = time_.reboot(now_ns); reboot != nullptr) {
    power_up(now_ns);
    time_.start_until(now_ns + (reboot->end_ns - reboot->start_ns));
  }
}

void MaestroDevice::tick(std::int64_t now_ns) {
  const double elapsed_s = time_.elapsed_s(now_ns);
  last_tick_ns_ = now_ns;
  follow_faults(now_ns);
  motor_.advance(elapsed_s);
  if (!has_pulse_ && options_.droop_radps != 0.0) {
    motor_.push(options_.droop_radps * counts_per_rad() * elapsed_s);
  }
  answers_.send_due(now_ns, time_.is_silent(now_ns), output_);
}

std::int64_t MaestroDevice::next_event_ns() const { return answers_.next_ns(last_tick_ns_ + kTickNs); }

std::vector<ServoFrame> MaestroDevice::take_output() { return std::exchange(output_, {}); }

}  // namespace odoless
