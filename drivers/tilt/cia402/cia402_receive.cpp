#include <algorithm>

#include "drivers/tilt/cia402/cia402_session.hpp"

// What a session makes of each frame that it receives.
namespace odoless {
namespace {

using canopen::NodeState;

constexpr std::int64_t kFaultPauseMinNs = 100'000'000;
constexpr std::int64_t kFaultPauseMaxNs = 2'000'000'000;
constexpr std::int64_t kFreshNs = 500'000'000;
constexpr int kStatusBytes = 7;
constexpr int kVelocityBytes = 4;

}  // namespace

void Cia402Session::receive(std::span<const std::byte> bytes, std::int64_t arrival_ns, TiltSink& sink) {
  if (is_finished()) {
    return;
  }
  const std::optional<CanFrame> frame = to_can_frame(bytes);
  if (!frame) {
    counters_.reject(Errc::kFrameMalformed, sink);
    return;
  }
  ++counters_.frames;
  if (frame->is_error()) {
    on_bus_error(*frame, arrival_ns, sink);
    return;
  }
  if (!frame->is_standard_data()) {
    return;  // of somebody else's protocol
  }
  const auto node = static_cast<std::uint32_t>(params_.id);
  if (frame->id == canopen::kSyncCob) {
    sync_ns_ = arrival_ns;
  } else if (frame->id == canopen::kTransmitPdo1Cob + node) {
    on_status(*frame, arrival_ns, sink);
  } else if (frame->id == canopen::kTransmitPdo2Cob + node) {
    on_velocity(*frame, sink);
  } else if (frame->id == canopen::kHeartbeatCob + node) {
    on_heartbeat(*frame, arrival_ns, sink);
  } else if (frame->id == canopen::kEmergencyCob + node) {
    on_emergency(*frame, arrival_ns, sink);
  } else if (frame->id == canopen::kSdoReplyCob + node) {
    const Result<canopen::SdoReply> reply = canopen::sdo_reply(*frame);
    if (reply.ok()) {
      on_sdo(sdo_.on_reply(reply.value()), arrival_ns, sink);
    } else {
      counters_.reject(reply.error(), sink);
    }
  }
}

void Cia402Session::on_bus_error(const CanFrame& frame, std::int64_t now_ns, TiltSink& sink) {
  ++counters_.bus_errors;
  const bool bus_off = (frame.id & CanFrame::kErrorBusOff) != 0;
  sink.on_event({.type = TiltEventType::kBusError,
                 .reason = bus_off ? Errc::kBusOff : Errc::kDeviceStatus,
                 .code = frame.id & CanFrame::kErrorMask});
  if (bus_off && phase_ != Phase::kPause) {
    give_up(Errc::kBusOff, now_ns, sink);
  } else if ((frame.id & CanFrame::kErrorRestarted) != 0 && phase_ == Phase::kPause) {
    enter(Phase::kFind, now_ns);
  }
}

void Cia402Session::on_emergency(const CanFrame& frame, std::int64_t now_ns, TiltSink& sink) {
  const Result<canopen::Emergency> emergency = canopen::emergency(frame);
  if (!emergency.ok()) {
    counters_.reject(emergency.error(), sink);
  } else if (emergency.value().code != 0) {
    last_emergency_ns_ = now_ns;
    drive_.forget_target();
    counters_.tell_device_error(TiltError::kEmergency, emergency.value().code, sink);
  }
}

void Cia402Session::on_heartbeat(const CanFrame& frame, std::int64_t now_ns, TiltSink& sink) {
  const Result<NodeState> state = canopen::heartbeat_state(frame);
  if (!state.ok()) {
    counters_.reject(state.error(), sink);
    return;
  }
  heard_heartbeat_ns_ = now_ns;
  if (state.value() == NodeState::kBootUp) {
    if (phase_ == Phase::kFind || phase_ == Phase::kPause) {
      enter(Phase::kFind, now_ns);
    } else {
      give_up(Errc::kDeviceRestarted, now_ns, sink);
    }
  } else if (is_cyclic() && phase_ != Phase::kStart && state.value() != NodeState::kOperational) {
    give_up(Errc::kDeviceStatus, now_ns, sink);  // somebody else has stopped it
  }
}

void Cia402Session::on_velocity(const CanFrame& frame, TiltSink& sink) {
  if (frame.size_bytes != kVelocityBytes) {
    counters_.reject(Errc::kFrameMalformed, sink);
    return;
  }
  const auto speed_units = static_cast<std::int32_t>(canopen::get(frame, 0, 4));
  velocity_radps_ = scale_.velocity_radps(static_cast<double>(speed_units) / params_.speed_units_per_count);
}

void Cia402Session::on_status(const CanFrame& frame, std::int64_t arrival_ns, TiltSink& sink) {
  if (!is_cyclic()) {
    return;
  }
  const auto status_word = static_cast<std::uint16_t>(canopen::get(frame, 0, 2));
  if (frame.size_bytes != kStatusBytes || !cia402::power_state(status_word)) {
    counters_.reject(Errc::kFrameMalformed, sink);
    return;
  }
  unanswered_syncs_ = 0;
  drive_.on_status({.status_word = status_word, .mode = static_cast<std::int8_t>(frame.data[6])});
  if (phase_ == Phase::kStart) {
    enter(homed_ ? Phase::kRun : Phase::kHomingMode, arrival_ns);
  }
  angle_rad_ = scale_.angle_rad(static_cast<std::int32_t>(canopen::get(frame, 2, 4)));
  if (phase_ == Phase::kRun || phase_ == Phase::kEnd) {
    pass_on(angle_rad_, arrival_ns, sink);
  }
  follow_power(arrival_ns, sink);
}

void Cia402Session::pass_on(double angle_rad, std::int64_t arrival_ns, TiltSink& sink) {
  const bool of_this_sync = arrival_ns >= sync_ns_ && arrival_ns - sync_ns_ < params_.sample_period_ns;
  TiltSample sample{.stamp_ns = of_this_sync ? sync_ns_ : arrival_ns,
                    .arrival_ns = arrival_ns,
                    .angle_rad = angle_rad,
                    .velocity_radps = velocity_radps_};
  if (sample.stamp_ns <= last_stamp_ns_) {
    counters_.reject(Errc::kImplausibleStamp, sink);  // a frame twice, or two for one SYNC
    return;
  }
  if (!gate_.passes(sample.stamp_ns, angle_rad)) {
    counters_.reject(Errc::kImplausibleAngle, sink);
    return;
  }
  last_stamp_ns_ = sample.stamp_ns;
  ++counters_.samples;
  motion_.on_angle(sample);
  sink.on_angle(sample);
}

void Cia402Session::start_fault(std::int64_t now_ns) {
  in_fault_ = true;
  fault_end_ns_ = now_ns + fault_pause_ns_;
  fault_pause_ns_ = std::min(2 * fault_pause_ns_, kFaultPauseMaxNs);
}

void Cia402Session::follow_power(std::int64_t now_ns, TiltSink& sink) {
  const bool is_new = !had_fault_ || now_ns >= fault_end_ns_;  // or its reset has failed
  if (drive_.has_fault() && !in_fault_ && is_new) {
    start_fault(now_ns);
    if (!sdo_.busy() && phase_ == Phase::kRun && now_ns - last_emergency_ns_ > kFreshNs) {
      sdo_.read(cia402::kErrorCode, now_ns);
      send_sdo();
    }
  }
  had_fault_ = drive_.has_fault();
  if (drive_.enabled() && !was_enabled_) {
    motion_.start(now_ns);
    enabled_since_ns_ = now_ns;
  } else if (drive_.enabled() && now_ns - enabled_since_ns_ >= kFaultPauseMaxNs) {
    fault_pause_ns_ = kFaultPauseMinNs;
  }
  was_enabled_ = drive_.enabled();
  not_enabled_since_ns_ = drive_.enabled() || in_fault_ ? now_ns : not_enabled_since_ns_;
  const bool obeys = drive_.enabled() || (motion_.command() == TiltCommand::kStop && !drive_.has_fault());
  if (phase_ == Phase::kRun && obeys && !ready_) {
    ready_ = true;
    silence_told_ = false;
    failures_ = 0;
    sink.on_event({.type = TiltEventType::kReady});
  }
}

}  // namespace odoless
