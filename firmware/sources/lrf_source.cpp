#include "firmware/sources/lrf_source.hpp"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <utility>

#include "drivers/io/serial_port.hpp"
#include "drivers/lrf/make_lrf_session.hpp"
#include "firmware/sources/device_status_text.hpp"
#include "firmware/sources/line_end.hpp"

namespace odoless {
namespace {

// Kinds of what is told that no reason of a session is.
constexpr Errc kStreams = Errc::kOk;
constexpr Errc kLineGone = Errc::kDeviceMissing;
constexpr Errc kReopened = Errc::kUnavailable;
constexpr Errc kNotWritten = Errc::kDeviceFailed;
constexpr Errc kUnanswered = Errc::kNotYet;

/// Why a laser that answers is not used.
EventText refusal(Errc reason) {
  switch (reason) {
    case Errc::kTooManyBeams:
      return "laser: refused: its scans have more beams than scan.beams_max, which must be larger";
    case Errc::kBadGeometry:
      return "laser: refused: the angles, ranges or speed that it says it has cannot be";
    case Errc::kFrameMalformed:
      return "laser: refused: it answers what its protocol does not know (lrf.driver; of an RPLIDAR lrf.rplidar_scan)";
    case Errc::kFrameTruncated:
      return "laser: refused: what it says of itself is incomplete";
    case Errc::kWrongSum:
      return "laser: refused: a check sum of what it says of itself does not match";
    default:
      return "laser: refused while it is started (reason {})";
  }
}

}  // namespace

LrfSource::LrfSource(const LrfParams& params, int beams_max, LineHandover& line)
    : params_(params),
      is_tcp_(params.device.starts_with("tcp://")),
      session_(make_lrf_session(params, beams_max)),
      line_(line) {}

void LrfSource::attach(GpioSignals& signals, std::optional<std::int64_t> sync_delay_ns) {
  signals_ = &signals;
  if (sync_delay_ns) {
    sync_.emplace(*sync_delay_ns);
  }
}

std::int64_t LrfSource::next_deadline_ns() const {
  const std::int64_t session_ns = is_open() ? session_->next_deadline_ns() : kNever_ns;
  return is_left_alone() ? std::min(session_ns, last_round_ns_ + kLeftAlone_ns) : session_ns;
}

void LrfSource::take_line(std::int64_t now_ns) {
  descriptor_ = line_.take();
  if (is_open()) {
    ++opened_;
    baud_ = params_.baud;
    has_rate_ = serial_baud(descriptor_) != 0;
    is_lost_ = false;
    last_scan_or_open_ns_ = now_ns;
    session_->reset(now_ns);
  }
}

void LrfSource::return_line() {
  line_.give_back(descriptor_);
  descriptor_ = -1;
}

void LrfSource::work(const Clock& clock, ScanSink& sink) {
  sink_ = &sink;
  if (!is_open()) {
    take_line(clock.now_ns());
  }
  if (is_open() && !read_all(clock)) {
    const int error_number = errno;
    tell_once(kLineGone, EventPriority::kWarning, laser_line_text(line_end_of(is_tcp_, error_number)), error_number);
    return_line();
  }
  if (is_open()) {
    const std::int64_t now_ns = clock.now_ns();
    const bool wait_is_over = now_ns >= session_->next_deadline_ns();
    session_->tick(now_ns, *this);
    set_rate();
    write_all();
    if (wait_is_over && is_lost_ && now_ns - last_scan_or_open_ns_ >= kReopen_ns) {
      tell_once(kReopened, EventPriority::kWarning,
                "laser: no scan for {} ms: its line is closed and opened again, until scans come",
                (now_ns - last_scan_or_open_ns_) / 1'000'000);
      return_line();
    }
  }
  sink_ = nullptr;
}

bool LrfSource::read_all(const Clock& clock) {
  for (int i = 0; i < kReadsPerRound; ++i) {
    errno = 0;  // 0 bytes: the other side has ended it
    const ssize_t size_bytes = ::read(descriptor_, buffer_.data(), buffer_.size());
    if (size_bytes == 0 || (size_bytes < 0 && errno != EAGAIN && errno != EINTR)) {
      return false;
    }
    if (size_bytes < 0) {
      count_empty_round(i == 0, clock.now_ns());
      return true;
    }
    empty_rounds_ = 0;
    const std::span<const std::byte> bytes = std::span(buffer_).first(static_cast<std::size_t>(size_bytes));
    sink_->on_raw(RawLine::kLaser, bytes, false);
    session_->receive(bytes, clock.now_ns(), *this);
  }
  return true;
}

// A poll that returns at once, again and again, of a line that has nothing to read, would take all of the processor.
void LrfSource::count_empty_round(bool is_empty, std::int64_t now_ns) {
  const bool came_soon = now_ns - last_round_ns_ < 2 * kLeftAlone_ns;
  empty_rounds_ = is_empty && came_soon ? std::min(empty_rounds_ + 1, kEmptyRounds) : 0;
  last_round_ns_ = now_ns;
}

void LrfSource::set_rate() {
  const int wanted = session_->line_baud();
  if (wanted == 0 || wanted == baud_ || !has_rate_) {
    return;
  }
  baud_ = wanted;
  if (set_serial_baud(descriptor_, wanted) != Errc::kOk) {
    tell_once(Errc::kBaudRefused, EventPriority::kWarning,
              "laser: its line cannot have {} baud, one of the rates at which the laser is looked for", wanted);
  }
}

void LrfSource::write_all() {
  const std::span<const std::byte> bytes = session_->transmit();
  if (bytes.empty()) {
    return;
  }
  errno = 0;  // fewer bytes: the line is full
  const bool is_written = ::write(descriptor_, bytes.data(), bytes.size()) == static_cast<ssize_t>(bytes.size());
  const bool has_ended = errno == EPIPE || errno == ECONNRESET;  // which the next read tells
  if (!is_written && !has_ended) {
    tell_once(kNotWritten, EventPriority::kWarning, "laser: its line does not take what is written (errno {})", errno);
  }
  sink_->on_raw(RawLine::kLaser, bytes, true);
}

void LrfSource::tell_once(Errc kind, EventPriority priority, EventText text, std::int64_t number) {
  if (const auto bit = static_cast<std::size_t>(kind); !told_[bit]) {
    told_[bit] = true;
    sink_->on_event(priority, text, number);
  }
}

void LrfSource::on_scan(const LrfScan& scan) {
  last_scan_or_open_ns_ = scan.arrival_ns;
  is_lost_ = false;
  told_.reset();
  told_device_status_.reset();
  RawScan raw;
  raw.stamp_ns = synchronized_ns(scan.stamp_ns);
  raw.start_angle_rad = scan.start_angle_rad;
  raw.angle_step_rad = scan.angle_step_rad;
  raw.beam_period_ns = params_.deskew ? scan.beam_period_ns : 0;
  raw.ranges_m = scan.ranges_m;
  sink_->on_scan(raw);
}

std::int64_t LrfSource::synchronized_ns(std::int64_t stamp_ns) {
  if (signals_ == nullptr) {
    return stamp_ns;
  }
  signals_->last_scan_ns.store(last_scan_or_open_ns_, std::memory_order_relaxed);
  if (!sync_) {
    return stamp_ns;
  }
  for (std::int64_t pulse_ns = 0; signals_->sync_pulses_ns.try_pop(pulse_ns);) {
    sync_->on_pulse(pulse_ns);
  }
  const std::int64_t refined_ns = sync_->refine(stamp_ns);
  signals_->sync_missing.store(sync_->missed_in_a_row() >= kSyncMissing, std::memory_order_relaxed);
  return refined_ns;
}

void LrfSource::on_event(const LrfEvent& event) {
  switch (event.type) {
    case LrfEventType::kReady:
      return tell_once(kStreams, EventPriority::kInfo, "laser: streaming, {} beams", session_->geometry().beams);
    case LrfEventType::kDeviceError:
      if (std::exchange(told_device_status_, event.device_status) != event.device_status) {
        sink_->on_event(EventPriority::kError, device_status_text(params_.driver, event.device_status),
                        event.device_status);
      }
      return;
    case LrfEventType::kLost:
      is_lost_ = true;
      return tell_once(Errc::kDeviceSilent, EventPriority::kWarning,
                       "laser: no data, or its connection closed; restarting it");
    case LrfEventType::kUnanswered:
      is_lost_ = true;
      return tell_once(kUnanswered, EventPriority::kWarning,
                       "laser: it answers, but not all that it is asked before it streams, or later than "
                       "lrf.reply_timeout_ms ({} ms), which must be longer then; it is asked again and again",
                       params_.reply_timeout_ns / 1'000'000);
    case LrfEventType::kRejected:
      if (!session_->ready()) {
        ++refused_;
        tell_once(event.reason, EventPriority::kError, refusal(event.reason), static_cast<std::int64_t>(event.reason));
      }
      return;  // of a stream: counted by the session
    case LrfEventType::kResync:
      return;  // counted
  }
}

void LrfSource::add_counts(SourceHealth& health) const {
  const LrfCounters& counters = session_->counters();
  health.rejected += static_cast<std::int64_t>(counters.rejected) + refused_;
  health.resyncs += static_cast<std::int64_t>(counters.resyncs);
  health.reconnects += std::max<std::int64_t>(opened_ - 1, 0);
}

}  // namespace odoless
