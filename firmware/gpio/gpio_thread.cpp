#include "firmware/gpio/gpio_thread.hpp"

#include <poll.h>

#include <array>

#include "firmware/gpio/status_light.hpp"

namespace odoless {
namespace {

bool is_high(PinLevel level) { return level == PinLevel::kHigh; }

/// Of a line that may be lost.
GpioLevel gpio_level_of(const Result<bool>& high) {
  return !high.ok() ? GpioLevel::kLost : high.value() ? GpioLevel::kHigh : GpioLevel::kLow;
}

/// Drains the edges of a line. @return  False when the line is lost.
template <class Take>
bool read_edges(GpioLine& line, const Take& take) {
  constexpr int kMost = 64;  // in a round: a line that flutters doesn't hold up the others
  for (int i = 0; i < kMost; ++i) {
    const Result<std::optional<GpioEdge>> edge = line.read_edge();
    if (!edge.ok()) {
      return false;
    }
    if (!edge.value()) {
      return true;
    }
    take(*edge.value());
  }
  return true;
}

void open_input(std::optional<GpioLine>& line, const std::string& name, GpioPull pull) {
  if (!line && !name.empty()) {
    if (Result<GpioLine> opened = GpioLine::open_input(name, pull); opened.ok()) {
      line.emplace(opened.take());
    }
  }
}

void open_output(std::optional<GpioLine>& line, const std::string& name, bool high) {
  if (!line && !name.empty()) {
    if (Result<GpioLine> opened = GpioLine::open_output(name, high); opened.ok()) {
      line.emplace(opened.take());
    }
  }
}

}  // namespace

GpioThread::GpioThread(const GpioParams& params, GpioSignals& signals, const MonotonicClock& clock,
                       const WakeUp& sensor, Outbox& outbox)
    : params_(params),
      signals_(signals),
      clock_(clock),
      sensor_(sensor),
      recorder_(outbox),
      power_(params.power_cycle_after_ns, params.power_off_ns, clock.now_ns()),
      thread_({.name = "odo-gpio", .priority = params.priority}) {
  signals_.has_stop_line = !params_.stop_line.empty();
  signals_.stopped = signals_.has_stop_line;
  signals_.line_lost = params_.is_used();
}

GpioThread::~GpioThread() { ending_.request(); }

int GpioThread::start() {
  if (!params_.is_used()) {
    return 0;
  }
  signals_.round_ns = clock_.now_ns();
  return thread_.start([this] { run(); });
}

void GpioThread::run() {
  while (!ending_.requested()) {
    open_lines(clock_.now_ns());
    wait();
    const std::int64_t now_ns = clock_.now_ns();
    serve_sync(now_ns);
    serve_stop(now_ns);
    serve_outputs(now_ns);
    signals_.line_lost = !has_all_lines();
    signals_.round_ns.store(now_ns, std::memory_order_release);
  }
  if (led_line_) {
    static_cast<void>(led_line_->set(!is_high(params_.led_level)));
  }
  if (power_line_) {
    static_cast<void>(power_line_->set(is_high(params_.power_level)));
  }
}

void GpioThread::open_lines(std::int64_t now_ns) {
  if (now_ns < next_open_ns_) {
    return;
  }
  next_open_ns_ = now_ns + kReopen_ns;
  open_input(stop_line_, params_.stop_line, is_high(params_.stop_level) ? GpioPull::kUp : GpioPull::kDown);
  open_input(sync_line_, params_.sync_line, GpioPull::kNone);
  open_output(power_line_, params_.power_line, is_high(params_.power_level));
  open_output(led_line_, params_.led_line, is_high(params_.led_level));
}

bool GpioThread::has_all_lines() const {
  return stop_line_.has_value() != params_.stop_line.empty() && sync_line_.has_value() != params_.sync_line.empty() &&
         power_line_.has_value() != params_.power_line.empty() && led_line_.has_value() != params_.led_line.empty();
}

void GpioThread::wait() {
  std::array<pollfd, 2> ready{
      pollfd{.fd = stop_line_ ? stop_line_->descriptor() : -1, .events = POLLIN | POLLPRI, .revents = 0},
      pollfd{.fd = sync_line_ ? sync_line_->descriptor() : -1, .events = POLLIN | POLLPRI, .revents = 0}};
  const timespec timeout{.tv_sec = 0, .tv_nsec = kRound_ns};
  static_cast<void>(::ppoll(ready.data(), ready.size(), &timeout, nullptr));
}

void GpioThread::serve_stop(std::int64_t now_ns) {
  if (params_.stop_line.empty()) {
    return;
  }
  bool pressed_between = false;  // and released again, before it was looked at
  if (stop_line_ && !read_edges(*stop_line_, [&](const GpioEdge& edge) {
        pressed_between = pressed_between || edge.high == is_high(params_.stop_level);
        recorder_.on_edge(GpioPin::kStop, edge.high, clock_.from_monotonic_ns(edge.monotonic_ns));
      })) {
    stop_line_.reset();
  }
  const Result<bool> level = stop_line_ ? stop_line_->level() : Result<bool>(Errc::kDeviceMissing);
  recorder_.on_level(GpioPin::kStop, gpio_level_of(level), now_ns);
  if (!level.ok()) {
    stop_line_.reset();
  }
  if (!level.ok() || pressed_between || level.value() == is_high(params_.stop_level)) {
    good_since_ns_ = -1;
    set_stopped(true);
    return;
  }
  good_since_ns_ = good_since_ns_ < 0 ? now_ns : good_since_ns_;
  set_stopped(signals_.stopped && now_ns - good_since_ns_ < kReleased_ns);
}

void GpioThread::set_stopped(bool stopped) {
  if (signals_.stopped.exchange(stopped) != stopped) {
    sensor_.notify();
  }
}

void GpioThread::serve_sync(std::int64_t now_ns) {
  if (!sync_line_) {
    return;
  }
  const bool rising = params_.sync_edge == PinEdge::kRising;
  const bool alive = read_edges(*sync_line_, [&](const GpioEdge& edge) {
    const std::int64_t stamp_ns = clock_.from_monotonic_ns(edge.monotonic_ns);
    if (edge.high == rising) {
      static_cast<void>(signals_.sync_pulses_ns.try_push(stamp_ns));
    }
    recorder_.on_edge(GpioPin::kSync, edge.high, stamp_ns);
  });
  const Result<bool> level = alive ? sync_line_->level() : Result<bool>(Errc::kDeviceMissing);
  recorder_.on_level(GpioPin::kSync, gpio_level_of(level), now_ns);
  if (!level.ok()) {
    sync_line_.reset();
  }
}

void GpioThread::serve_outputs(std::int64_t now_ns) {
  if (power_line_) {
    const bool on = power_.update(now_ns, signals_.last_scan_ns.load(std::memory_order_relaxed));
    signals_.power_cycles.store(power_.cycles(), std::memory_order_relaxed);
    set_output(power_line_, GpioPin::kPower, on == is_high(params_.power_level), now_ns);
  }
  if (led_line_) {
    const bool on = status_light_is_on(signals_.state, signals_.stopped, now_ns);
    set_output(led_line_, GpioPin::kLed, on == is_high(params_.led_level), now_ns);
  }
}

void GpioThread::set_output(std::optional<GpioLine>& line, GpioPin pin, bool high, std::int64_t now_ns) {
  const bool alive = line->set(high) == Errc::kOk;
  recorder_.on_level(pin, alive ? gpio_level_of(high) : GpioLevel::kLost, now_ns);
  if (!alive) {
    line.reset();
  }
}

}  // namespace odoless
