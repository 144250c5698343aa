#include "firmware/sources/tilt_source.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string_view>
#include <utility>

#include "drivers/io/can_frame.hpp"
#include "drivers/io/candump_text.hpp"
#include "firmware/sources/tilt_event_text.hpp"

namespace odoless {

TiltSource::TiltSource(const TiltParams& params, LineHandover& line)
    : params_(params),
      session_(make_tilt_session(params)),
      line_(line),
      history_(10 * params.sample_period_ns),
      wanted_(params.at_start) {}

std::int64_t TiltSource::next_deadline_ns() const {
  if (!is_open()) {
    return ScanSource::kNever_ns;
  }
  return is_link_down_ ? std::min(session_->next_deadline_ns(), now_ns_ + kLinkPause_ns) : session_->next_deadline_ns();
}

void TiltSource::take_line(std::int64_t now_ns) {
  descriptor_ = line_.take();
  if (is_open()) {
    is_link_down_ = false;
    session_->reset(now_ns);
  }
}

void TiltSource::return_line() {
  line_.give_back(descriptor_);
  descriptor_ = -1;
  has_angle_ = false;
}

void TiltSource::obey(std::int64_t now_ns) {
  const bool stopped = gpio_ != nullptr && gpio_->is_stopped(now_ns);
  const TiltCommand command = stopped ? TiltCommand::kStop : wanted_.load(std::memory_order_acquire);
  session_->command(command, now_ns);
  if (command != TiltCommand::kStop && session_->state() == TiltState::kHoming) {
    seen_since_ns_ = std::numeric_limits<std::int64_t>::max();
  }
}

void TiltSource::end(std::int64_t now_ns) {
  ends_ = true;
  const bool stopped = gpio_ != nullptr && gpio_->is_stopped(now_ns);
  session_->finish(stopped ? TiltEnd::kHold : params_.at_end, now_ns);
}

void TiltSource::work(const Clock& clock, ScanSink& sink) {
  sink_ = &sink;
  now_ns_ = clock.now_ns();
  if (!is_open() && !ends_) {
    take_line(now_ns_);
  }
  if (is_open()) {
    bool alive = read_all(clock);
    now_ns_ = clock.now_ns();
    if (!ends_) {
      obey(now_ns_);
    }
    session_->tick(now_ns_, *this);
    alive = write_all() && alive;
    if (!alive) {
      sink.on_event(EventPriority::kWarning,
                    "tilt servo: its line was unplugged or closed at the other end; it is opened again when it is back",
                    0);
      return_line();
    }
  }
  sink_ = nullptr;
}

bool TiltSource::read_all(const Clock& clock) {
  for (int i = 0; i < kReadsPerRound; ++i) {
    const Result<TiltRead> read = read_tilt_line(params_.driver, descriptor_, buffer_, clock);
    is_link_down_ = read.error() == Errc::kLinkDown;
    tell_link(read.error());
    if (read.error() == Errc::kNotYet || is_link_down_) {
      return true;
    }
    if (!read.ok()) {
      return false;
    }
    tell_raw(read.value().bytes, read.value().arrival_ns, false);
    session_->receive(read.value().bytes, read.value().arrival_ns, *this);
  }
  return true;
}

// What the line doesn't take is lost, which the session finds out by itself.
bool TiltSource::write_all() {
  bool alive = true;
  for (auto frame = session_->transmit(); !frame.empty(); frame = session_->transmit()) {
    const Errc error = write_tilt_line(params_.driver, descriptor_, frame);
    tell_link(error);
    tell_raw(frame, now_ns_, true);
    alive = alive && (error == Errc::kOk || error == Errc::kCapacity || error == Errc::kLinkDown);
  }
  return alive;
}

void TiltSource::tell_link(Errc error) {
  const bool down = error == Errc::kLinkDown;
  if (down == link_told_down_ || (!down && error != Errc::kOk)) {
    return;
  }
  link_told_down_ = down;
  if (down) {
    sink_->on_event(EventPriority::kWarning,
                    "tilt servo: its CAN interface is down: 'ip link set ... up' brings it up (tilt.device)", 0);
  } else {
    sink_->on_event(EventPriority::kNotice, "tilt servo: its CAN interface is up", 0);
  }
}

void TiltSource::tell_raw(std::span<const std::byte> bytes, std::int64_t stamp_ns, bool to_device) {
  const std::optional<CanFrame> frame =
      params_.driver == TiltDriver::kCia402 ? to_can_frame(bytes) : std::optional<CanFrame>();
  if (!frame) {
    return sink_->on_raw(RawLine::kTilt, bytes, to_device);
  }
  std::array<char, kCandumpTextMax + 1> buffer{};
  const std::string_view line =
      candump_text(stamp_ns / 1000, params_.device, *frame, std::span(buffer).first<kCandumpTextMax>());
  buffer.at(line.size()) = '\n';  // the messages' data, one after the other, are a log of candump
  sink_->on_raw(RawLine::kTilt, std::as_bytes(std::span(buffer).first(line.size() + 1)), to_device);
}

TiltReport TiltSource::report() const {
  const TiltState state = session_->state();
  const TiltCounters& counters = session_->counters();
  const bool obeys = is_open() && state != TiltState::kBringUp && state != TiltState::kFault;
  return {.used = true,
          .obeys = obeys,
          .level = has_angle_ && is_level(last_angle_rad_),
          .sweeps = state == TiltState::kSweeping,
          .refused = static_cast<std::int64_t>(counters.rejected + counters.timeouts)};
}

bool TiltSource::is_level(double angle_rad) const { return std::abs(angle_rad) <= params_.level_tolerance_rad; }

bool TiltSource::was_level_since(std::int64_t stamp_ns) const {
  if (stamp_ns < seen_since_ns_) {
    return false;
  }
  if (!had_angle_) {
    return true;
  }
  const Result<double> then_rad = history_.angle_rad(stamp_ns);
  return is_level(last_angle_rad_) && (!then_rad.ok() || is_level(then_rad.value()));
}

void TiltSource::on_angle(const TiltSample& sample) {
  has_angle_ = had_angle_ = true;
  seen_since_ns_ = std::min(seen_since_ns_, sample.stamp_ns);
  last_angle_rad_ = sample.angle_rad;
  static_cast<void>(history_.add(sample.stamp_ns, sample.angle_rad));
  sink_->on_tilt({.stamp_ns = sample.stamp_ns, .angle_rad = sample.angle_rad, .velocity_radps = sample.velocity_radps});
}

void TiltSource::on_event(const TiltEvent& event) {
  if (event.type == TiltEventType::kLost) {
    has_angle_ = false;
  }
  if (event.type == TiltEventType::kReady) {
    told_ = {};
  } else if (!is_news(event)) {
    return;
  }
  const TiltEventText said = text_of(event);
  sink_->on_event(said.priority, said.text, said.number);
}

// What goes wrong goes wrong again at each attempt, and on a bus in trouble thousands of times a second.
bool TiltSource::is_news(const TiltEvent& event) {
  const auto type = static_cast<std::size_t>(event.type);
  const std::size_t kind = event.type == TiltEventType::kDoesWithout
                               ? kTiltEventTypes + kTiltErrors + static_cast<std::size_t>(event.code)
                           : event.error == TiltError::kNone ? type
                                                             : kTiltEventTypes + static_cast<std::size_t>(event.error);
  Told& told = told_.at(kind);
  const std::int64_t pause_ns = told.event == event ? kSameEventPause_ns : kEventPause_ns;
  if (told.at_ns != 0 && now_ns_ - told.at_ns < pause_ns) {
    return false;
  }
  told = {event, now_ns_};
  return true;
}

}  // namespace odoless
