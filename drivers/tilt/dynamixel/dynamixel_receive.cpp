#include <algorithm>
#include <cstdlib>

#include "drivers/tilt/dynamixel/dynamixel_session.hpp"

// What a session makes of each packet that it receives.
namespace odoless {
namespace {

using dynamixel::Packet;
using dynamixel::PacketReader;

constexpr std::int64_t kRebootNs = 600'000'000;
constexpr std::int64_t kMomentNs = 1'000'000;
constexpr std::int64_t kPauseNs = 100'000'000;
constexpr std::int64_t kFaultPauseMaxNs = 2'000'000'000;
constexpr std::int64_t kTickSlackMs = 500;
constexpr std::int64_t kBitsPerByte = 10;  ///< 8N1

}  // namespace

void DynamixelSession::receive(std::span<const std::byte> bytes, std::int64_t arrival_ns, TiltSink& sink) {
  while (true) {
    switch (reader_.take(bytes)) {
      case PacketReader::Outcome::kMore:
        return;
      case PacketReader::Outcome::kBad:
        counters_.reject(reader_.error(), sink);
        break;
      case PacketReader::Outcome::kPacket:
        ++counters_.frames;
        on_packet(arrival_ns, sink);
        break;
    }
  }
}

void DynamixelSession::on_packet(std::int64_t arrival_ns, TiltSink& sink) {
  const Packet& packet = reader_.packet();
  if (!packet.is_status()) {
    const bool is_own = std::ranges::equal(reader_.raw(), request_.span());
    counters_.echoes += is_own ? 1 : 0;
    if (!is_own) {
      counters_.reject(Errc::kWrongEcho, sink);
    }
    return;
  }
  const bool is_wanted = busy_ && packet.id == params_.id;
  const bool is_refusal = (packet.error() & dynamixel::kErrorNumber) != 0;
  if (!is_wanted || (packet.size != answer_bytes_ + 1 && !is_refusal)) {
    counters_.reject(is_wanted ? Errc::kWrongCount : Errc::kWrongEcho, sink);
    return;
  }
  if ((packet.error() & dynamixel::kErrorNumber) == dynamixel::kCrcError) {
    counters_.reject(Errc::kWrongSum, sink);  // what was asked got damaged on its way
    on_timeout(arrival_ns, sink);
    return;
  }
  tries_ = 0;
  busy_ = false;
  if (is_refusal) {
    counters_.tell_device_error(TiltError::kErrorNumber, packet.error(), sink, asked_address_);
    give_up(Errc::kDeviceStatus, kPauseNs, arrival_ns, sink);
    return;
  }
  health_is_due_ = health_is_due_ || (packet.error() & dynamixel::kAlert) != 0;
  on_answer(packet, arrival_ns, sink);
}

void DynamixelSession::on_answer(const Packet& packet, std::int64_t arrival_ns, TiltSink& sink) {
  if (end_ && step_ < Step::kEndGoal) {
    return begin_end(arrival_ns);
  }
  switch (step_) {
    case Step::kPing:
      return on_found(packet, arrival_ns, sink);
    case Step::kCheckHealth:
    case Step::kPollHealth:
      return on_health(packet, arrival_ns, sink);
    case Step::kReboot:
      return give_up(Errc::kDeviceRestarted, kRebootNs, arrival_ns, sink);
    case Step::kReadSettings:
      return on_settings(packet, arrival_ns);
    case Step::kFindPosition:
      position_counts_ =
          static_cast<std::int32_t>(packet.get(dynamixel::kPresentPosition - dynamixel::kMotionFirst, 4));
      return enter(Step::kGoalHere, arrival_ns);
    case Step::kPollMotion:
      return on_motion(packet, arrival_ns, sink);
    case Step::kRun:
    case Step::kGoal:
      return go_on(arrival_ns);
    case Step::kLimits:
      return enter(Step::kClearWatchdog, arrival_ns);
    case Step::kEndGoal:
    case Step::kEndRelease:
      return enter(Step::kEndWatchdog, arrival_ns);
    case Step::kEndWatchdog:
      return enter(Step::kEnded, arrival_ns);
    case Step::kPause:
    case Step::kEnded:
      return;
    default:
      return enter(static_cast<Step>(static_cast<int>(step_) + 1), arrival_ns);
  }
}

void DynamixelSession::on_found(const Packet& packet, std::int64_t now_ns, TiltSink& sink) {
  const std::uint32_t model_number = packet.get(0, 2);
  const std::optional<dynamixel::ControlTable> table = dynamixel::control_table(model_number);
  if (!table) {
    counters_.tell_device_error(TiltError::kModel, model_number, sink);
    return give_up(Errc::kWrongDevice, kFaultPauseMaxNs, now_ns, sink);
  }
  use(*table);
  enter(Step::kAnswerAll, now_ns);
}

void DynamixelSession::on_settings(const Packet& packet, std::int64_t now_ns) {
  std::copy_n(packet.parameters.begin() + 1, settings_.size(), settings_.begin());
  step_ = Step::kReturnDelay;
  next_setting(now_ns);
  if (step_ != Step::kClearWatchdog) {
    enter(Step::kTorqueOff, now_ns);  // something is to be written, which needs it
  }
}

void DynamixelSession::on_health(const Packet& packet, std::int64_t now_ns, TiltSink& sink) {
  const std::uint32_t hardware_error = packet.get(dynamixel::kHardwareError - dynamixel::kHealthFirst, 1);
  const bool has_torque = packet.get(dynamixel::kTorqueEnable - dynamixel::kHealthFirst, 1) != 0;
  health_is_due_ = false;
  if (hardware_error != 0) {
    counters_.tell_device_error(TiltError::kHardware, hardware_error, sink);
    give_up(Errc::kDeviceStatus, fault_pause_ns_, now_ns, sink);
    fault_pause_ns_ = std::min(2 * fault_pause_ns_, kFaultPauseMaxNs);
    has_error_ = reboot_is_due_ = true;
  } else if (step_ == Step::kCheckHealth) {
    enter(Step::kReadSettings, now_ns);
  } else if (!has_torque) {
    give_up(Errc::kDeviceRestarted, kPauseNs, now_ns, sink);
  } else {
    fault_pause_ns_ = kPauseNs;
    go_on(now_ns);
  }
}

void DynamixelSession::on_motion(const Packet& packet, std::int64_t arrival_ns, TiltSink& sink) {
  const std::uint32_t tick_ms = packet.get(0, 2);
  const std::int64_t host_ms = (arrival_ns - tick_arrival_ns_) / 1'000'000;
  if (tick_ms_) {
    const auto wrapped_ms =
        (static_cast<std::int64_t>(tick_ms) - *tick_ms_ + dynamixel::kTickWrapMs) % dynamixel::kTickWrapMs;
    const std::int64_t off_ms = std::abs(wrapped_ms - host_ms);
    if (std::min(off_ms, dynamixel::kTickWrapMs - off_ms) > kTickSlackMs) {
      give_up(Errc::kDeviceRestarted, kMomentNs, arrival_ns, sink);
      return;
    }
  }
  tick_ms_ = tick_ms;
  tick_arrival_ns_ = arrival_ns;
  const auto raw_velocity =
      static_cast<std::int32_t>(packet.get(dynamixel::kPresentVelocity - dynamixel::kMotionFirst, 4));
  const auto position = static_cast<std::int32_t>(packet.get(dynamixel::kPresentPosition - dynamixel::kMotionFirst, 4));
  const std::int64_t on_the_line_ns =
      params_.baud == 0 ? 0
                        : static_cast<std::int64_t>(reader_.raw().size()) * kBitsPerByte * 1'000'000'000 / params_.baud;
  const TiltSample sample{.stamp_ns = std::max(arrival_ns - on_the_line_ns, std::min(asked_ns_, arrival_ns)),
                          .arrival_ns = arrival_ns,
                          .angle_rad = scale_.angle_rad(position),
                          .velocity_radps = (params_.inverted ? -1.0 : 1.0) * raw_velocity * table_.speed_unit_radps};
  if (sample.stamp_ns <= last_stamp_ns_ || !gate_.passes(sample.stamp_ns, sample.angle_rad)) {
    counters_.reject(sample.stamp_ns <= last_stamp_ns_ ? Errc::kImplausibleStamp : Errc::kImplausibleAngle, sink);
    go_on(arrival_ns);
    return;
  }
  position_counts_ = position;
  last_stamp_ns_ = sample.stamp_ns;
  ++counters_.samples;
  motion_.on_angle(sample);
  if (!ready_) {
    ready_ = true;
    silence_told_ = has_error_ = false;
    sink.on_event({.type = TiltEventType::kReady});
  }
  sink.on_angle(sample);
  go_on(arrival_ns);
}

void DynamixelSession::go_on(std::int64_t now_ns) {
  step_ = Step::kRun;
  if (goal_is_due()) {
    enter(Step::kGoal, now_ns);
  } else if (health_is_due_) {
    health_is_due_ = false;
    enter(Step::kPollHealth, now_ns);
  }
}

}  // namespace odoless
