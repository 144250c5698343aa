#include "firmware/sources/tilt_source.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

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
  descriptor_ = line_.offered.exchange(-1, std::memory_order_acq_rel);
  if (is_open()) {
    is_link_down_ = false;
    session_->reset(now_ns);
  }
}

void TiltSource::return_line() {
  line_.returned.store(descriptor_, std::memory_order_release);
  line_.in_use.store(false, std::memory_order_release);
  descriptor_ = -1;
  has_angle_ = false;
}

void TiltSource::obey(std::int64_t now_ns) {
  const bool stopped = stopped_ != nullptr && stopped_->load(std::memory_order_acquire);
  session_->command(stopped ? TiltCommand::kStop : wanted_.load(std::memory_order_acquire), now_ns);
}

void TiltSource::work(std::int64_t now_ns, ScanSink& sink) {
  sink_ = &sink;
  now_ns_ = now_ns;
  if (!is_open()) {
    take_line(now_ns);
  }
  if (is_open()) {
    bool alive = read_all(now_ns);
    obey(now_ns);
    session_->tick(now_ns, *this);
    alive = write_all() && alive;
    if (!alive) {
      sink.on_event(EventPriority::kWarning, "tilt servo: its line is gone; it is opened again when it is back", 0);
      return_line();
    }
  }
  sink_ = nullptr;
}

bool TiltSource::read_all(std::int64_t now_ns) {
  for (int i = 0; i < kReadsPerRound; ++i) {
    const Result<TiltRead> read = read_tilt_line(params_.driver, descriptor_, buffer_, now_ns);
    is_link_down_ = read.error() == Errc::kLinkDown;
    if (read.error() == Errc::kNotYet || is_link_down_) {
      return true;
    }
    if (!read.ok()) {
      return false;
    }
    session_->receive(read.value().bytes, read.value().arrival_ns, *this);
  }
  return true;
}

// What the line doesn't take is lost, which the session finds out by itself.
bool TiltSource::write_all() {
  bool alive = true;
  for (auto frame = session_->transmit(); !frame.empty(); frame = session_->transmit()) {
    const Errc error = write_tilt_line(params_.driver, descriptor_, frame);
    alive = alive && (error == Errc::kOk || error == Errc::kCapacity || error == Errc::kLinkDown);
  }
  return alive;
}

TiltReport TiltSource::report() const {
  const TiltState state = session_->state();
  const bool obeys = is_open() && state != TiltState::kBringUp && state != TiltState::kFault;
  return {.used = true,
          .obeys = obeys,
          .level = has_angle_ && std::abs(last_angle_rad_) <= 2.0 * params_.tolerance_rad,
          .stalls = static_cast<std::int64_t>(session_->counters().stalls)};
}

void TiltSource::on_angle(const TiltSample& sample) {
  has_angle_ = true;
  last_angle_rad_ = sample.angle_rad;
  static_cast<void>(history_.add(sample.stamp_ns, sample.angle_rad));
  sink_->on_tilt({.stamp_ns = sample.stamp_ns, .angle_rad = sample.angle_rad, .velocity_radps = sample.velocity_radps});
}

void TiltSource::on_event(const TiltEvent& event) {
  switch (event.type) {
    case TiltEventType::kReady:
      return sink_->on_event(EventPriority::kInfo, "tilt servo: set up, obeys", 0);
    case TiltEventType::kDeviceError:
      return sink_->on_event(EventPriority::kError, "tilt servo: it reports an error, code {:#x}", event.code);
    case TiltEventType::kStalled:
      return sink_->on_event(EventPriority::kError, "tilt servo: stalled: it was stopped, and is tried again", 0);
    case TiltEventType::kLost:
      has_angle_ = false;
      return sink_->on_event(EventPriority::kWarning, "tilt servo: lost (reason {}); it is brought up again",
                             static_cast<std::int64_t>(event.reason));
    case TiltEventType::kBusError:
      if (now_ns_ >= next_bus_event_ns_) {  // a bus in trouble tells of it thousands of times a second
        next_bus_event_ns_ = now_ns_ + kEventPause_ns;
        sink_->on_event(EventPriority::kWarning, "tilt servo: errors on its bus, class {:#x}", event.code);
      }
      return;
    case TiltEventType::kRejected:
      return;  // counted
  }
}

TiltKeeper::TiltKeeper(TiltParams params, LineHandover& line, WakeUp& sensor)
    : params_(std::move(params)), line_(line), sensor_(sensor) {}

TiltKeeper::~TiltKeeper() {
  const FileDescriptor offered(line_.offered.exchange(-1));
  const FileDescriptor returned(line_.returned.exchange(-1));
}

Errc TiltKeeper::tick(std::int64_t now_ns) {
  const bool in_use =
      line_.in_use.load(std::memory_order_acquire);  // first: a line that was returned is then seen, too
  const FileDescriptor returned(line_.returned.exchange(-1, std::memory_order_acq_rel));  // closed here
  if (in_use || now_ns < next_try_ns_) {
    return Errc::kOk;
  }
  next_try_ns_ = now_ns + kPause_ns;
  if (returned.valid()) {
    return Errc::kOk;
  }
  Result<FileDescriptor> opened = open_tilt_line(params_);
  if (!opened.ok()) {
    return opened.error();
  }
  line_.in_use.store(true, std::memory_order_release);
  line_.offered.store(opened.take().release(), std::memory_order_release);
  sensor_.notify();
  return Errc::kOk;
}

}  // namespace odoless
