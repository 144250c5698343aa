#include "drivers/tilt/dynamixel/dynamixel_session.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

namespace odoless {
namespace {

using dynamixel::Instruction;

constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::max();
constexpr std::int64_t kMomentNs = 1'000'000;
constexpr std::int64_t kPauseNs = 100'000'000;
constexpr std::int64_t kFaultPauseMaxNs = 2'000'000'000;
constexpr int kTries = 3;
constexpr int kPollsPerHealth = 10;
constexpr std::int64_t kWatchdogUnitNs = 20'000'000;

std::uint32_t profile_units(double value, double unit, std::uint32_t most) {
  return static_cast<std::uint32_t>(
      std::clamp(std::round(value / unit), 1.0, std::max(1.0, static_cast<double>(most))));
}

std::uint32_t watchdog_units(const TiltParams& params) {
  const std::int64_t timeout_ns = 3 * std::max(params.heartbeat_period_ns, params.sample_period_ns);
  return static_cast<std::uint32_t>(std::clamp<std::int64_t>(timeout_ns / kWatchdogUnitNs, 1, 127));
}

}  // namespace

DynamixelSession::DynamixelSession(const TiltParams& params)
    : params_(params),
      scale_(params, table_.counts_per_turn, table_.centre_counts),
      motion_(params),
      gate_(2.0 * params.speed_radps + 2.0),
      fault_pause_ns_(kPauseNs) {
  use(table_);
}

void DynamixelSession::use(const dynamixel::ControlTable& table) {
  table_ = table;
  scale_ = TiltScale(params_, table.counts_per_turn, table.centre_counts);
  const auto limit_counts = [&](double limit_rad) {
    return std::clamp(scale_.position_counts(limit_rad), table.position_min(), table.position_max());
  };
  std::tie(low_counts_, high_counts_) =
      std::minmax({limit_counts(params_.limit_min_rad), limit_counts(params_.limit_max_rad)});
}

void DynamixelSession::reset(std::int64_t now_ns) {
  counters_.restarts += was_reset_ ? 1 : 0;
  was_reset_ = true;
  reader_.clear();
  end_.reset();
  enter(Step::kPing, now_ns);
}

// What was asked is answered first: two on a half-duplex line at once are heard by nobody.
void DynamixelSession::finish(TiltEnd end, std::int64_t now_ns) {
  has_run_ = runs();
  const bool levels = end == TiltEnd::kLevel && has_run_ && !in_fault_;
  motion_.command(levels ? TiltCommand::kLevel : TiltCommand::kStop, now_ns);
  end_ = end;
  if (!busy_) {
    begin_end(now_ns);
  }
}

void DynamixelSession::begin_end(std::int64_t now_ns) {
  tries_ = 0;
  if (end_ == TiltEnd::kRelease && was_reset_) {
    enter(Step::kEndRelease, now_ns);
  } else {
    enter(has_run_ ? Step::kEndGoal : Step::kEnded, now_ns);
  }
}

void DynamixelSession::command(TiltCommand command, std::int64_t now_ns) {
  motion_.command(command, now_ns);
  if (runs() && !busy_ && goal_is_due()) {
    enter(Step::kGoal, now_ns);
  }
}

std::int32_t DynamixelSession::wished_counts() const {
  return std::clamp(scale_.position_counts(motion_.target_rad()), low_counts_, high_counts_);
}

bool DynamixelSession::goal_is_due() const {
  return stops() ? !goal_is_stop_ : goal_is_stop_ || goal_counts_ != wished_counts();
}

void DynamixelSession::ask(Instruction instruction, std::span<const std::uint8_t> parameters, std::size_t answer_bytes,
                           std::int64_t now_ns) {
  request_ = dynamixel::encode(params_.id, instruction, parameters);
  answer_bytes_ = answer_bytes;
  asked_address_ = 0;
  asked_ns_ = now_ns;
  busy_ = true;
  to_be_sent_ = true;
}

void DynamixelSession::read(std::uint16_t address_in_x, std::uint16_t size_bytes, std::int64_t now_ns) {
  const std::uint16_t address = table_.address(address_in_x);
  const std::array<std::uint8_t, 4> parameters{
      static_cast<std::uint8_t>(address & 0xFFU), static_cast<std::uint8_t>(address >> 8U),
      static_cast<std::uint8_t>(size_bytes & 0xFFU), static_cast<std::uint8_t>(size_bytes >> 8U)};
  ask(Instruction::kRead, parameters, size_bytes, now_ns);
  asked_address_ = address;
}

void DynamixelSession::write(std::uint16_t address_in_x, std::span<const std::uint32_t> values, std::size_t value_bytes,
                             std::int64_t now_ns) {
  const std::uint16_t address = table_.address(address_in_x);
  std::array<std::uint8_t, 16> parameters{static_cast<std::uint8_t>(address & 0xFFU),
                                          static_cast<std::uint8_t>(address >> 8U)};
  std::size_t count = 2;
  for (std::uint32_t value : values) {
    for (std::size_t i = 0; i < value_bytes; ++i, value >>= 8U) {
      parameters[count++] = static_cast<std::uint8_t>(value & 0xFFU);
    }
  }
  ask(Instruction::kWrite, std::span(parameters).first(count), 0, now_ns);
  asked_address_ = address;
}

// The profile goes with every goal, so that it holds whatever happened to the servo between. A stop has none: as fast
// as the servo can, to where it is. A servo takes no goal outside its limits: one that is there goes to the nearest.
void DynamixelSession::write_goal(bool is_stop, std::int64_t now_ns) {
  goal_is_stop_ = is_stop;
  goal_counts_ = is_stop ? std::clamp(position_counts_, low_counts_, high_counts_) : wished_counts();
  const bool at_once = is_stop && goal_counts_ == position_counts_;
  const std::array<std::uint32_t, 3> values{
      at_once ? 0
              : profile_units(params_.acceleration_radps2, table_.acceleration_unit_radps2,
                              profile_max(dynamixel::kAccelerationLimit)),
      at_once ? 0 : profile_units(params_.speed_radps, table_.speed_unit_radps, profile_max(dynamixel::kVelocityLimit)),
      static_cast<std::uint32_t>(*goal_counts_)};
  write(dynamixel::kProfile, values, 4, now_ns);
}

void DynamixelSession::enter(Step step, std::int64_t now_ns) {
  const auto write_one = [&](std::uint16_t address, std::uint32_t value, std::size_t size_bytes) {
    write(address, std::span(&value, 1), size_bytes, now_ns);
  };
  step_ = step;
  switch (step) {
    case Step::kPing:
      ready_ = false;
      goal_counts_.reset();
      tick_ms_.reset();
      gate_.restart();
      return ask(Instruction::kPing, {}, 3, now_ns);
    case Step::kAnswerAll:
      return write_one(dynamixel::kStatusReturnLevel, dynamixel::kAnswersAll, 1);
    case Step::kCheckHealth:
    case Step::kPollHealth:
      return read(dynamixel::kHealthFirst, dynamixel::kHealthBytes, now_ns);
    case Step::kReboot:
      return ask(Instruction::kReboot, {}, 0, now_ns);
    case Step::kReadSettings:
      return read(dynamixel::kSettingsFirst, dynamixel::kSettingsBytes, now_ns);
    case Step::kTorqueOff:
    case Step::kEndRelease:
      return write_one(dynamixel::kTorqueEnable, 0, 1);
    case Step::kReturnDelay:
    case Step::kMode:
    case Step::kLimits:
      return next_setting(now_ns);
    case Step::kClearWatchdog:
    case Step::kEndWatchdog:
      return write_one(dynamixel::kBusWatchdog, 0, 1);
    case Step::kFindPosition:
    case Step::kPollMotion:
      return read(dynamixel::kMotionFirst, dynamixel::kMotionBytes, now_ns);
    case Step::kGoalHere:
      return write_goal(true, now_ns);
    case Step::kGoal:
    case Step::kEndGoal:
      return write_goal(stops(), now_ns);
    case Step::kTorqueOn:
      return write_one(dynamixel::kTorqueEnable, 1, 1);
    case Step::kWatchdog:
      return write_one(dynamixel::kBusWatchdog, watchdog_units(params_), 1);
    case Step::kRun:
      busy_ = false;
      next_poll_ns_ = now_ns;
      motion_.start(now_ns);
      return;
    case Step::kPause:
    case Step::kEnded:
      busy_ = false;
      return;
  }
}

std::uint32_t DynamixelSession::setting(std::uint16_t address, std::size_t size_bytes) const {
  const std::size_t first = std::size_t{address} - dynamixel::kSettingsFirst;
  std::uint32_t value = 0;
  for (std::size_t i = size_bytes; i > 0; --i) {
    value = value << 8U | settings_[first + i - 1];
  }
  return value;
}

std::uint32_t DynamixelSession::profile_max(std::uint16_t limit_address) const {
  return table_.limits_profile ? setting(limit_address, 4) : dynamixel::kProfileMax;
}

// From kReturnDelay on: the first of these that differs is written, and then the next looked for.
void DynamixelSession::next_setting(std::int64_t now_ns) {
  const auto have = [&](std::uint16_t address) { return setting(address, 1); };
  if (step_ == Step::kReturnDelay) {
    const std::uint32_t mode_bits = have(dynamixel::kDriveMode) & ~std::uint32_t{dynamixel::kTimeBasedProfile};
    if (have(dynamixel::kReturnDelay) != 0 || have(dynamixel::kDriveMode) != mode_bits) {
      const std::array<std::uint32_t, 2> values{0, mode_bits};
      return write(dynamixel::kReturnDelay, values, 1, now_ns);
    }
    step_ = Step::kMode;
  }
  if (step_ == Step::kMode) {
    if (have(dynamixel::kOperatingMode) != dynamixel::kPositionControl) {
      const std::array<std::uint32_t, 1> values{dynamixel::kPositionControl};
      return write(dynamixel::kOperatingMode, values, 1, now_ns);
    }
    step_ = Step::kLimits;
  }
  const std::array<std::uint32_t, 2> limits{static_cast<std::uint32_t>(high_counts_),
                                            static_cast<std::uint32_t>(low_counts_)};
  if (setting(dynamixel::kPositionMax, 4) != limits[0] || setting(dynamixel::kPositionMin, 4) != limits[1]) {
    return write(dynamixel::kPositionMax, limits, 4, now_ns);
  }
  enter(Step::kClearWatchdog, now_ns);
}

void DynamixelSession::give_up(Errc reason, std::int64_t pause_ns, std::int64_t now_ns, TiltSink& sink) {
  if (end_) {
    return enter(Step::kEnded, now_ns);
  }
  if (ready_ || !silence_told_) {
    sink.on_event({.type = TiltEventType::kLost, .reason = reason});
  }
  silence_told_ = true;
  ready_ = false;
  tries_ = 0;
  ++counters_.restarts;
  pause_end_ns_ = now_ns + pause_ns;
  reader_.clear();
  enter(Step::kPause, now_ns);
}

std::span<const std::byte> DynamixelSession::transmit() {
  return std::exchange(to_be_sent_, false) && busy_ ? std::as_bytes(request_.span()) : std::span<const std::byte>();
}

void DynamixelSession::on_timeout(std::int64_t now_ns, TiltSink& sink) {
  ++counters_.timeouts;
  busy_ = false;
  if (end_ && step_ < Step::kEndGoal) {
    begin_end(now_ns);
  } else if (step_ == Step::kAnswerAll) {
    enter(Step::kCheckHealth, now_ns);  // at its level of before, this may go unanswered; the next won't
  } else if (++tries_ >= kTries) {
    give_up(Errc::kDeviceSilent, kPauseNs, now_ns, sink);
  } else if (step_ == Step::kPollMotion || step_ == Step::kPollHealth) {
    go_on(now_ns);
  } else {
    asked_ns_ = now_ns;
    busy_ = true;
    to_be_sent_ = true;
  }
}

// A servo that has heard nothing for as long as its watchdog takes has stopped itself and takes no goals.
void DynamixelSession::watch(std::int64_t now_ns, TiltSink& sink) {
  const bool was_deaf = now_ns - asked_ns_ > watchdog_units(params_) * kWatchdogUnitNs;
  if (was_deaf) {
    give_up(Errc::kDeviceSilent, kMomentNs, now_ns, sink);
    return;
  }
  if (in_fault_ && now_ns >= fault_end_ns_) {
    in_fault_ = false;
    motion_.start(now_ns);
  }
  if (ready_ && !in_fault_ && motion_.is_stalled(now_ns)) {
    ++counters_.stalls;
    in_fault_ = true;
    fault_end_ns_ = now_ns + kFaultPauseMaxNs;
    sink.on_event({.type = TiltEventType::kStalled, .reason = Errc::kStalled});
  }
}

void DynamixelSession::tick(std::int64_t now_ns, TiltSink& sink) {
  if (now_ns < next_deadline_ns()) {
    return;
  }
  if (busy_) {
    on_timeout(now_ns, sink);
  }
  if (step_ == Step::kPause && now_ns >= pause_end_ns_) {
    enter(std::exchange(reboot_is_due_, false) ? Step::kReboot : Step::kPing, now_ns);
  }
  if (!runs() || busy_) {
    return;
  }
  watch(now_ns, sink);
  if (!runs()) {
    return;
  }
  if (goal_is_due()) {
    enter(Step::kGoal, now_ns);
  } else if (now_ns >= next_poll_ns_) {
    next_poll_ns_ = std::max(next_poll_ns_ + params_.sample_period_ns, now_ns + params_.sample_period_ns / 2);
    health_is_due_ = ++polls_ % kPollsPerHealth == 0;
    enter(Step::kPollMotion, now_ns);
  }
}

std::int64_t DynamixelSession::next_deadline_ns() const {
  if (!was_reset_) {
    return kNever;
  }
  if (busy_) {
    return asked_ns_ + params_.reply_timeout_ns;
  }
  if (step_ == Step::kEnded) {
    return kNever;
  }
  return runs() ? next_poll_ns_ : pause_end_ns_;
}

TiltState DynamixelSession::state() const {
  if (in_fault_ || has_error_) {
    return TiltState::kFault;
  }
  return ready_ ? motion_.state() : TiltState::kBringUp;
}

}  // namespace odoless
