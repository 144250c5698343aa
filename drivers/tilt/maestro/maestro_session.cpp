#include "drivers/tilt/maestro/maestro_session.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace odoless {
namespace {

using maestro::Code;

constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::max();
constexpr std::int64_t kPauseNs = 100'000'000;
constexpr int kTries = 3;
constexpr int kPollsPerErrors = 10;
constexpr std::int64_t kBitsPerByte = 10;  ///< 8N1

unsigned units(double value, double unit, unsigned most) {
  return static_cast<unsigned>(std::clamp(std::round(value / unit), 1.0, static_cast<double>(most)));
}

}  // namespace

MaestroSession::MaestroSession(const TiltParams& params)
    : params_(params),
      scale_(params, params.pulse_turn_us * maestro::kCountsPerUs, params.pulse_centre_us * maestro::kCountsPerUs),
      motion_(params),
      speed_units_(units(scale_.counts(params.speed_radps), maestro::kSpeedUnitCountsPerS, maestro::kNumberMax)),
      acceleration_units_(units(scale_.counts(params.acceleration_radps2), maestro::kAccelerationUnitCountsPerS2,
                                maestro::kAccelerationMax)) {}

void MaestroSession::reset(std::int64_t now_ns) {
  counters_.restarts += was_reset_ ? 1 : 0;
  was_reset_ = true;
  tries_ = 0;
  find(now_ns);
}

void MaestroSession::command(TiltCommand command, std::int64_t now_ns) {
  motion_.command(command, now_ns);
  if (step_ == Step::kRun && command == TiltCommand::kStop && !target_is_stop_) {
    next_poll_ns_ = std::min(next_poll_ns_, now_ns);
  }
}

// What is asked for meanwhile is answered before: its two bytes are taken for the position, which nobody needs here.
void MaestroSession::finish(TiltEnd end, std::int64_t now_ns) {
  const bool can_move = step_ == Step::kRun && position_counts_ != maestro::kNoPulse;
  end_ = end == TiltEnd::kLevel && !can_move ? TiltEnd::kHold : end;
  motion_.command(end_ == TiltEnd::kLevel ? TiltCommand::kLevel : TiltCommand::kStop, now_ns);
  if (!was_reset_) {
    step_ = Step::kEnded;
    return;
  }
  step_ = Step::kEnd;
  tries_ = 0;
  ask_position(now_ns);
}

unsigned MaestroSession::counts_of(double angle_rad) const {
  const std::int32_t counts =
      scale_.position_counts(std::clamp(angle_rad, params_.limit_min_rad, params_.limit_max_rad));
  return static_cast<unsigned>(std::clamp(counts, 1, static_cast<std::int32_t>(maestro::kNumberMax)));
}

std::optional<unsigned> MaestroSession::wished_counts() const {
  if (step_ == Step::kEnd && end_ == TiltEnd::kRelease) {
    return maestro::kNoPulse;
  }
  if (motion_.command() != TiltCommand::kStop) {
    return counts_of(motion_.target_rad());
  }
  if (position_counts_ == maestro::kNoPulse) {
    return std::nullopt;
  }
  const double way_counts = static_cast<double>(target_counts_.value_or(position_counts_)) - position_counts_;
  const double speed_counts_per_s = speed_units_ * maestro::kSpeedUnitCountsPerS;
  const double slope_counts_per_s2 = acceleration_units_ * maestro::kAccelerationUnitCountsPerS2;
  const double braking_counts = speed_counts_per_s * speed_counts_per_s / (2.0 * slope_counts_per_s2);
  const double stop_counts =
      position_counts_ + std::copysign(std::min(std::abs(way_counts), braking_counts), way_counts);
  return counts_of(scale_.angle_rad(static_cast<std::int32_t>(std::lround(stop_counts))));
}

void MaestroSession::find(std::int64_t now_ns) {
  step_ = Step::kFind;
  ready_ = false;
  forget_what_it_was_told();
  position_counts_ = maestro::kNoPulse;
  ask_errors(now_ns);
}

void MaestroSession::ask(std::int64_t now_ns) {
  answer_size_ = 0;
  asked_ns_ = now_ns;
  busy_ = to_be_sent_ = true;
}

void MaestroSession::ask_errors(std::int64_t now_ns) {
  wants_errors_ = true;
  commands_.clear();
  commands_.add(Code::kGetErrors);
  ask(now_ns);
}

// What it is told goes before the question. A stop is one target, told once.
void MaestroSession::ask_position(std::int64_t now_ns) {
  commands_.clear();
  if (!std::exchange(has_profile_, true)) {
    commands_.add(Code::kSetSpeed, params_.channel, speed_units_)
        .add(Code::kSetAcceleration, params_.channel, acceleration_units_);
  }
  const bool is_stop = motion_.command() == TiltCommand::kStop;
  const bool is_told = step_ != Step::kEnd && is_stop && target_is_stop_;
  const std::optional<unsigned> wished = is_told ? target_counts_ : wished_counts();
  if (wished && (wished != target_counts_ || step_ == Step::kEnd)) {
    commands_.add(Code::kSetTarget, params_.channel, *wished);
    target_counts_ = wished;
  }
  target_is_stop_ = is_stop && wished.has_value();
  wants_errors_ = false;
  commands_.add(Code::kGetPosition, params_.channel);
  ask(now_ns);
}

std::span<const std::byte> MaestroSession::transmit() {
  return std::exchange(to_be_sent_, false) && busy_ ? commands_.bytes() : std::span<const std::byte>();
}

void MaestroSession::receive(std::span<const std::byte> bytes, std::int64_t arrival_ns, TiltSink& sink) {
  for (const std::byte byte : bytes) {
    if (!busy_) {
      counters_.reject(Errc::kWrongEcho, sink);
      return;
    }
    answer_[answer_size_++] = byte;
    if (answer_size_ == answer_.size()) {
      ++counters_.frames;
      busy_ = false;
      on_answer(std::to_integer<unsigned>(answer_[0]) | std::to_integer<unsigned>(answer_[1]) << 8U, arrival_ns, sink);
    }
  }
}

void MaestroSession::on_answer(unsigned number, std::int64_t arrival_ns, TiltSink& sink) {
  tries_ = 0;
  if (step_ == Step::kEnd) {
    step_ = Step::kEnded;
  } else if (wants_errors_) {
    on_errors(number, arrival_ns, sink);
  } else {
    on_position(number, arrival_ns, sink);
  }
}

// It may not have heard it.
void MaestroSession::forget_what_it_was_told() {
  has_profile_ = target_is_stop_ = false;
  target_counts_.reset();
}

// Of a line that was just opened, errors are of what was on it before.
void MaestroSession::on_errors(unsigned flags, std::int64_t now_ns, TiltSink& sink) {
  if (step_ == Step::kFind) {
    step_ = Step::kRun;
    motion_.start(now_ns);
    next_poll_ns_ = now_ns;
  } else if (flags != 0) {
    counters_.tell_device_error(TiltError::kErrorFlags, flags, sink);
    forget_what_it_was_told();
  }
}

void MaestroSession::on_position(unsigned counts, std::int64_t arrival_ns, TiltSink& sink) {
  if (counts > maestro::kNumberMax) {
    return counters_.reject(Errc::kImplausibleAngle, sink);
  }
  const unsigned before = std::exchange(position_counts_, counts);
  const std::int64_t on_the_line_ns = params_.baud == 0 ? 0
                                                        : static_cast<std::int64_t>(maestro::kAnswerBytes) *
                                                              kBitsPerByte * 1'000'000'000 / params_.baud;
  const std::int64_t stamp_ns = std::max(arrival_ns - on_the_line_ns, std::min(asked_ns_, arrival_ns));
  const double elapsed_s = static_cast<double>(stamp_ns - last_stamp_ns_) * 1e-9;
  const bool has_stopped_pulses = counts == maestro::kNoPulse && before != maestro::kNoPulse;
  if (has_stopped_pulses) {
    return give_up(Errc::kDeviceRestarted, arrival_ns, sink);
  }
  if (!ready_) {
    ready_ = true;
    silence_told_ = false;
    sink.on_event({.type = TiltEventType::kReady});
    sink.on_event({.type = TiltEventType::kDoesWithout, .code = static_cast<std::int64_t>(TiltLack::kMeasurement)});
  }
  if (counts == maestro::kNoPulse || stamp_ns <= last_stamp_ns_) {
    return;
  }
  const double velocity_counts_per_s =
      before == maestro::kNoPulse ? 0.0 : (static_cast<double>(counts) - static_cast<double>(before)) / elapsed_s;
  last_stamp_ns_ = stamp_ns;
  ++counters_.samples;
  const TiltSample sample{.stamp_ns = stamp_ns,
                          .arrival_ns = arrival_ns,
                          .angle_rad = scale_.angle_rad(static_cast<std::int32_t>(counts)),
                          .velocity_radps = scale_.velocity_radps(velocity_counts_per_s)};
  motion_.on_angle(sample);
  sink.on_angle(sample);
}

void MaestroSession::give_up(Errc reason, std::int64_t now_ns, TiltSink& sink) {
  if (step_ == Step::kEnd) {
    step_ = Step::kEnded;
    return;
  }
  if (ready_ || !silence_told_) {
    sink.on_event({.type = TiltEventType::kLost, .reason = reason});
  }
  silence_told_ = true;
  ready_ = false;
  tries_ = 0;
  ++counters_.restarts;
  step_ = Step::kPause;
  next_poll_ns_ = now_ns + kPauseNs;
}

void MaestroSession::on_timeout(std::int64_t now_ns, TiltSink& sink) {
  ++counters_.timeouts;
  busy_ = false;
  if (++tries_ >= kTries) {
    give_up(Errc::kDeviceSilent, now_ns, sink);
  } else if (step_ == Step::kFind) {
    find(now_ns);
  } else {
    forget_what_it_was_told();
    ask_position(now_ns);
  }
}

void MaestroSession::tick(std::int64_t now_ns, TiltSink& sink) {
  if (now_ns < next_deadline_ns()) {
    return;
  }
  if (busy_) {
    on_timeout(now_ns, sink);
  }
  if (busy_ || now_ns < next_poll_ns_) {
    return;
  }
  if (step_ == Step::kPause) {
    find(now_ns);
  } else if (step_ == Step::kRun) {
    next_poll_ns_ = std::max(next_poll_ns_ + params_.sample_period_ns, now_ns + params_.sample_period_ns / 2);
    if (++polls_ % kPollsPerErrors == 0) {
      ask_errors(now_ns);
    } else {
      ask_position(now_ns);
    }
  }
}

std::int64_t MaestroSession::next_deadline_ns() const {
  if (!was_reset_ || step_ == Step::kEnded) {
    return kNever;
  }
  return busy_ ? asked_ns_ + params_.reply_timeout_ns : next_poll_ns_;
}

TiltState MaestroSession::state() const {
  if (!ready_) {
    return TiltState::kBringUp;
  }
  return position_counts_ == maestro::kNoPulse ? TiltState::kStopped : motion_.state();
}

}  // namespace odoless
