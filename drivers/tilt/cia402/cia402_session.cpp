#include "drivers/tilt/cia402/cia402_session.hpp"

#include <algorithm>
#include <limits>

namespace odoless {
namespace {

using canopen::NmtCommand;
using canopen::NodeState;
using canopen::SdoClient;
using cia402::Drive;
using cia402::HomingState;

constexpr std::uint32_t kDriveProfile = 402;
constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::max();
constexpr std::int64_t kPauseNs = 100'000'000;
constexpr std::int64_t kStartNs = 500'000'000;       ///< from the start command to the first status
constexpr std::int64_t kSwitchOnNs = 2'000'000'000;  ///< brakes may take half a second
constexpr std::int64_t kFaultResetNs = 500'000'000;  ///< for the drive to get rid of a fault
constexpr std::int64_t kStallPauseNs = 2'000'000'000;
constexpr std::int64_t kHeldUpNs = 50'000'000;
constexpr int kUnansweredMax = 10;  ///< SYNCs, and not a time: this process may be held up as well
constexpr int kFailuresBeforeReset = 3;

/// Pushed by hand, it may be faster than it drives.
double speed_max_radps(const TiltParams& params) { return 2.0 * params.speed_radps + 2.0; }

}  // namespace

Cia402Session::Cia402Session(const TiltParams& params)
    : params_(params),
      scale_(params, params.counts_per_turn, 0.0),
      set_up_(params, scale_),
      sdo_(params.id, params.reply_timeout_ns),
      motion_(params),
      ramp_(params.speed_radps, params.acceleration_radps2),
      gate_(speed_max_radps(params)) {}

void Cia402Session::reset(std::int64_t now_ns) {
  counters_.restarts += was_reset_ ? 1 : 0;
  was_reset_ = true;
  waiting_out_ = 0;
  failures_ = 0;
  next_heartbeat_ns_ = now_ns;
  enter(Phase::kFind, now_ns);
}

void Cia402Session::command(TiltCommand command, std::int64_t now_ns) {
  if (command == motion_.command()) {
    return;
  }
  motion_.command(command, now_ns);
  not_enabled_since_ns_ = now_ns;
  if (command == TiltCommand::kStop && is_cyclic()) {
    next_sync_ns_ = std::min(next_sync_ns_, now_ns);
  }
}

void Cia402Session::send(const CanFrame& frame) {
  if (waiting_out_ < outbox_.size()) {
    outbox_[(first_out_ + waiting_out_) % outbox_.size()] = frame;
    ++waiting_out_;
  }
}

void Cia402Session::send_sdo() {
  if (const std::optional<CanFrame> request = sdo_.take_request()) {
    send(*request);
  }
}

std::span<const std::byte> Cia402Session::transmit() {
  if (waiting_out_ == 0) {
    return {};
  }
  sent_ = outbox_[first_out_];
  first_out_ = (first_out_ + 1) % outbox_.size();
  --waiting_out_;
  return as_bytes(sent_);
}

void Cia402Session::enter(Phase phase, std::int64_t now_ns) {
  phase_ = phase;
  phase_end_ns_ = now_ns + kStartNs;
  switch (phase) {
    case Phase::kFind:
      ready_ = in_fault_ = was_enabled_ = had_fault_ = false;
      drive_.restart();
      gate_.restart();
      send(canopen::nmt(NmtCommand::kPreOperational, params_.id));
      sdo_.read(cia402::kDeviceType, now_ns);
      break;
    case Phase::kSetUp:
      setting_ = 0;
      has_heartbeat_ = true;
      next_setting(now_ns);
      break;
    case Phase::kReadMark:
      sdo_.read(cia402::kZeroMark, now_ns);
      break;
    case Phase::kStart:
      send(canopen::nmt(NmtCommand::kStart, params_.id));
      next_sync_ns_ = now_ns;
      heard_heartbeat_ns_ = now_ns;
      break;
    case Phase::kHomingMode:
      sdo_.write(cia402::kModeOfOperation, cia402::kHoming, 1, now_ns);
      break;
    case Phase::kHoming:
      phase_end_ns_ = now_ns + params_.homing_timeout_ns;
      break;
    case Phase::kProfileMode:
      gate_.restart();
      sdo_.write(cia402::kModeOfOperation, cia402::run_mode(params_), 1, now_ns);
      break;
    case Phase::kWriteMark:
      sdo_.write(cia402::kZeroMark, cia402::zero_mark(params_.homing_method), 4, now_ns);
      break;
    case Phase::kRun:
      not_enabled_since_ns_ = now_ns;
      motion_.start(now_ns);
      break;
    case Phase::kEnd:
      if (params_.cyclic_position && end_ == TiltEnd::kLevel) {
        sdo_.write(cia402::kModeOfOperation, cia402::kProfilePosition, 1, now_ns);  // to go on alone
      } else if (params_.master_id != 0) {
        sdo_.write(cia402::kWatchedHeartbeat, 0, 4, now_ns);
      }
      break;
    case Phase::kEnded:
      sdo_.cancel();
      break;
    case Phase::kPause:
      ready_ = false;
      sdo_.cancel();
      phase_end_ns_ = now_ns + kPauseNs;
      break;
  }
  send_sdo();
}

void Cia402Session::give_up(Errc reason, std::int64_t now_ns, TiltSink& sink) {
  if (phase_ == Phase::kEnd) {
    return enter(Phase::kEnded, now_ns);
  }
  if (ready_ || !silence_told_) {
    sink.on_event({.type = TiltEventType::kLost, .reason = reason});
  }
  silence_told_ = true;
  ++counters_.restarts;
  ++failures_;
  enter(Phase::kPause, now_ns);
  if (failures_ % kFailuresBeforeReset == 0) {
    send(canopen::nmt(NmtCommand::kResetCommunication, params_.id));
  }
}

void Cia402Session::next_setting(std::int64_t now_ns) {
  const auto settings = set_up_.settings();
  if (setting_ == settings.size()) {
    homed_ = params_.homing_method == 0;
    enter(homed_ ? Phase::kStart : Phase::kReadMark, now_ns);
    return;
  }
  const cia402::Setting& setting = settings[setting_];
  sdo_.write(setting.object, setting.value, setting.size_bytes, now_ns);
}

void Cia402Session::on_setting(bool was_refused, std::int64_t now_ns, TiltSink& sink) {
  if (const std::optional<TiltLack> lack = was_refused ? set_up_.lack_without(setting_) : std::nullopt; lack) {
    has_heartbeat_ = has_heartbeat_ && *lack != TiltLack::kHeartbeat;
    sink.on_event(
        {.type = TiltEventType::kDoesWithout, .reason = Errc::kDeviceStatus, .code = static_cast<std::int64_t>(*lack)});
  }
  setting_ = set_up_.next(setting_, was_refused);
  next_setting(now_ns);
}

void Cia402Session::on_found(std::int64_t now_ns, TiltSink& sink) {
  if ((sdo_.value() & 0xFFFFU) == kDriveProfile) {
    enter(Phase::kSetUp, now_ns);
  } else {
    counters_.tell_device_error(TiltError::kDeviceType, sdo_.value(), sink);
    give_up(Errc::kWrongDevice, now_ns, sink);
  }
}

// Whether the drive may go on although it has refused what it was asked. One without the mark's object finds its zero
// at each bring-up, which must not be wherever it just is.
bool Cia402Session::tolerates() const {
  if (phase_ == Phase::kReadMark || phase_ == Phase::kWriteMark) {
    return !cia402::homes_here(params_.homing_method);
  }
  return phase_ == Phase::kSetUp && cia402::SetUp::tolerates(set_up_.settings()[setting_], sdo_.value());
}

void Cia402Session::on_sdo(SdoClient::Outcome outcome, std::int64_t now_ns, TiltSink& sink) {
  const bool aborted = outcome == SdoClient::Outcome::kAborted;
  counters_.timeouts += outcome == SdoClient::Outcome::kTimedOut ? 1 : 0;
  if (outcome == SdoClient::Outcome::kPending) {
    send_sdo();
    return;
  }
  if (phase_ == Phase::kEnd) {
    return on_end_written(outcome == SdoClient::Outcome::kDone, now_ns);
  }
  if (phase_ == Phase::kRun) {  // the code of a fault was asked for
    const std::int64_t code = outcome == SdoClient::Outcome::kDone ? std::int64_t{sdo_.value()} : -1;
    counters_.tell_device_error(TiltError::kFault, code, sink);
    return;
  }
  if (outcome != SdoClient::Outcome::kDone && !(aborted && tolerates())) {
    if (aborted) {
      const canopen::Object object = sdo_.object();
      counters_.tell_device_error(TiltError::kAbort, sdo_.value(), sink, object.index * 256U + object.sub);
    }
    give_up(aborted ? Errc::kDeviceStatus : Errc::kDeviceSilent, now_ns, sink);
    return;
  }
  if (phase_ == Phase::kFind) {
    on_found(now_ns, sink);
  } else if (phase_ == Phase::kSetUp) {
    on_setting(aborted, now_ns, sink);
  } else if (phase_ == Phase::kReadMark) {
    homed_ = !aborted && sdo_.value() == cia402::zero_mark(params_.homing_method);
    enter(Phase::kStart, now_ns);
  } else if (phase_ == Phase::kHomingMode) {
    enter(Phase::kHoming, now_ns);
  } else if (phase_ == Phase::kProfileMode) {
    enter(Phase::kWriteMark, now_ns);
  } else if (phase_ == Phase::kWriteMark) {
    enter(Phase::kRun, now_ns);
  }
  send_sdo();
}

std::int32_t Cia402Session::next_counts(std::int64_t now_ns) {
  if (!drive_.is_cyclic()) {
    return scale_.position_counts(motion_.target_rad());
  }
  if (!drive_.enabled() || motion_.command() == TiltCommand::kStop || in_fault_) {
    ramp_.start(angle_rad_);
  } else {
    const std::int64_t elapsed_ns = std::clamp<std::int64_t>(now_ns - sync_ns_, 0, 2 * params_.sample_period_ns);
    static_cast<void>(ramp_.step(motion_.target_rad(), static_cast<double>(elapsed_ns) * 1e-9));
  }
  return scale_.position_counts(ramp_.angle_rad());
}

Drive::Goal Cia402Session::goal() const {
  if (phase_ == Phase::kEnd && end_ == TiltEnd::kRelease) {
    return Drive::Goal::kRelease;
  }
  if (motion_.command() == TiltCommand::kStop || in_fault_) {
    return Drive::Goal::kStop;
  }
  switch (phase_) {
    case Phase::kHoming:
      return drive_.mode() == static_cast<std::int8_t>(cia402::kHoming) ? Drive::Goal::kHome : Drive::Goal::kWait;
    case Phase::kRun:
      return drive_.mode() == static_cast<std::int8_t>(cia402::run_mode(params_)) ? Drive::Goal::kMove
                                                                                  : Drive::Goal::kWait;
    case Phase::kEnd:
      return Drive::Goal::kMove;
    default:
      return Drive::Goal::kWait;
  }
}

void Cia402Session::cycle(std::int64_t now_ns, TiltSink& sink) {
  if (in_fault_ && now_ns >= fault_end_ns_) {
    in_fault_ = false;
    fault_end_ns_ = now_ns + kFaultResetNs;
    not_enabled_since_ns_ = now_ns;
    motion_.start(now_ns);
  }
  if (phase_ == Phase::kRun && drive_.enabled() && !in_fault_ && motion_.is_stalled(now_ns)) {
    ++counters_.stalls;
    sink.on_event({.type = TiltEventType::kStalled, .reason = Errc::kStalled});
    in_fault_ = true;
    fault_end_ns_ = now_ns + kStallPauseNs;
  }
  const Drive::Output output = drive_.next(goal(), next_counts(now_ns));
  CanFrame command;
  command.id = canopen::kReceivePdo1Cob + static_cast<std::uint32_t>(params_.id);
  command.size_bytes = 6;
  canopen::put(command, 0, output.control_word, 2);
  canopen::put(command, 2, static_cast<std::uint32_t>(output.target_counts), 4);
  send(command);
  send(canopen::sync());
  sync_ns_ = now_ns;
  ++unanswered_syncs_;
  next_sync_ns_ = std::max(next_sync_ns_ + params_.sample_period_ns, now_ns + params_.sample_period_ns / 2);
}

void Cia402Session::watch(std::int64_t now_ns, TiltSink& sink) {
  if (!is_cyclic()) {
    return;
  }
  const bool silent = has_heartbeat_ && now_ns - heard_heartbeat_ns_ >= 3 * params_.heartbeat_period_ns;
  const bool no_status = phase_ != Phase::kStart && unanswered_syncs_ >= kUnansweredMax;
  if (silent || no_status) {
    give_up(Errc::kDeviceSilent, now_ns, sink);
  } else if (phase_ == Phase::kRun && motion_.command() != TiltCommand::kStop && !in_fault_ && !drive_.enabled() &&
             now_ns - not_enabled_since_ns_ >= kSwitchOnNs) {
    counters_.tell_device_error(TiltError::kStatusWord, drive_.status_word(), sink);
    give_up(Errc::kDeviceStatus, now_ns, sink);
  }
}

void Cia402Session::advance(std::int64_t now_ns, TiltSink& sink) {
  if (phase_ == Phase::kPause && now_ns >= phase_end_ns_) {
    enter(Phase::kFind, now_ns);
  } else if (phase_ == Phase::kStart && now_ns >= phase_end_ns_) {
    give_up(Errc::kDeviceSilent, now_ns, sink);
  } else if (phase_ == Phase::kEnd && is_left_as_wished()) {
    enter(Phase::kEnded, now_ns);
  } else if (phase_ == Phase::kHoming) {
    const HomingState homing = drive_.homing();
    if (homing == HomingState::kAttained) {
      enter(Phase::kProfileMode, now_ns);
    } else if (motion_.command() == TiltCommand::kStop) {
      phase_end_ns_ = now_ns + params_.homing_timeout_ns;  // counts from when it may move
    } else if (homing == HomingState::kFailed || now_ns >= phase_end_ns_) {
      counters_.tell_device_error(TiltError::kStatusWord, drive_.status_word(), sink);
      give_up(Errc::kHomingFailed, now_ns, sink);
    }
  }
}

void Cia402Session::tick(std::int64_t now_ns, TiltSink& sink) {
  if (now_ns - last_tick_ns_ >
      std::max(5 * params_.sample_period_ns, kHeldUpNs)) {  // held up: what was seen of the motion before is history
    motion_.start(now_ns);
    drive_.forget_target();
    ramp_.start(angle_rad_);
    gate_.restart();
  }
  last_tick_ns_ = now_ns;
  if (now_ns < next_deadline_ns()) {
    return;
  }
  if (sends_heartbeat() && now_ns >= next_heartbeat_ns_) {
    next_heartbeat_ns_ = std::max(next_heartbeat_ns_ + params_.heartbeat_period_ns, now_ns + 1);
    send(canopen::heartbeat(params_.master_id, NodeState::kOperational));
  }
  if (sdo_.busy() && now_ns >= sdo_.deadline_ns()) {
    on_sdo(sdo_.on_deadline(now_ns), now_ns, sink);
  }
  watch(now_ns, sink);
  advance(now_ns, sink);
  if (is_cyclic() && now_ns >= next_sync_ns_) {
    cycle(now_ns, sink);
  }
}

std::int64_t Cia402Session::next_deadline_ns() const {
  if (!was_reset_) {
    return kNever;
  }
  std::int64_t deadline_ns = is_cyclic() ? next_sync_ns_ : phase_ == Phase::kPause ? phase_end_ns_ : kNever;
  if (sends_heartbeat()) {
    deadline_ns = std::min(deadline_ns, next_heartbeat_ns_);
  }
  if (sdo_.busy()) {
    deadline_ns = std::min(deadline_ns, sdo_.deadline_ns());
  }
  return deadline_ns;
}

TiltState Cia402Session::state() const {
  if (in_fault_ || (drive_.has_fault() && is_cyclic())) {
    return TiltState::kFault;
  }
  if (phase_ >= Phase::kHomingMode && phase_ <= Phase::kWriteMark) {
    return TiltState::kHoming;
  }
  return phase_ == Phase::kRun && ready_ ? motion_.state() : TiltState::kBringUp;
}

}  // namespace odoless
