#include "firmware/sources/lrf_source.hpp"

#include <unistd.h>

#include <algorithm>
#include <cerrno>

#include "drivers/io/serial_port.hpp"
#include "drivers/lrf/make_lrf_session.hpp"

namespace odoless {

LrfSource::LrfSource(const LrfParams& params, int beams_max, LineHandover& line)
    : params_(params), session_(make_lrf_session(params, beams_max)), line_(line) {}

void LrfSource::attach(GpioSignals& signals, std::optional<std::int64_t> sync_delay_ns) {
  signals_ = &signals;
  if (sync_delay_ns) {
    sync_.emplace(*sync_delay_ns);
  }
}

std::int64_t LrfSource::next_deadline_ns() const {
  return is_open() ? std::min(session_->next_deadline_ns(), last_scan_or_open_ns_ + kReopen_ns) : kNever_ns;
}

void LrfSource::take_line(std::int64_t now_ns) {
  descriptor_ = line_.offered.exchange(-1, std::memory_order_acq_rel);
  if (is_open()) {
    ++opened_;
    baud_ = params_.baud;
    last_scan_or_open_ns_ = now_ns;
    session_->reset(now_ns);
  }
}

void LrfSource::return_line() {
  line_.returned.store(descriptor_, std::memory_order_release);
  line_.in_use.store(false, std::memory_order_release);
  descriptor_ = -1;
}

void LrfSource::work(std::int64_t now_ns, ScanSink& sink) {
  sink_ = &sink;
  if (!is_open()) {
    take_line(now_ns);
  }
  if (is_open() && !read_all(now_ns)) {
    sink.on_event(EventPriority::kWarning, "laser: its line is gone (errno {}); it is opened again when it is back",
                  errno);
    return_line();
  }
  if (is_open()) {
    session_->tick(now_ns, *this);
    write_all();
  }
  if (is_open() && now_ns - last_scan_or_open_ns_ >= kReopen_ns) {
    return_line();
  }
  sink_ = nullptr;
}

bool LrfSource::read_all(std::int64_t now_ns) {
  for (int i = 0; i < kReadsPerRound; ++i) {
    errno = 0;  // 0 bytes: the other side has ended it
    const ssize_t size_bytes = ::read(descriptor_, buffer_.data(), buffer_.size());
    if (size_bytes == 0 || (size_bytes < 0 && errno != EAGAIN && errno != EINTR)) {
      return false;
    }
    if (size_bytes < 0) {
      return true;
    }
    const std::span<const std::byte> bytes = std::span(buffer_).first(static_cast<std::size_t>(size_bytes));
    sink_->on_raw(RawLine::kLaser, bytes, false);
    session_->receive(bytes, now_ns, *this);
  }
  return true;
}

void LrfSource::write_all() {
  if (const int wanted = session_->line_baud(); wanted != 0 && wanted != baud_) {
    write_errors_ += set_serial_baud(descriptor_, wanted) == Errc::kOk ? 0 : 1;
    baud_ = wanted;
  }
  const std::span<const std::byte> bytes = session_->transmit();
  if (!bytes.empty()) {
    const ssize_t written = ::write(descriptor_, bytes.data(), bytes.size());
    write_errors_ += written == static_cast<ssize_t>(bytes.size()) ? 0 : 1;  // the session asks again
    sink_->on_raw(RawLine::kLaser, bytes, true);
  }
}

void LrfSource::on_scan(const LrfScan& scan) {
  last_scan_or_open_ns_ = scan.arrival_ns;
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
      return sink_->on_event(EventPriority::kInfo, "laser: streaming, {} beams", session_->geometry().beams);
    case LrfEventType::kDeviceError:
      return sink_->on_event(EventPriority::kError, "laser: it reports an error, status {}", event.device_status);
    case LrfEventType::kLost:
      return sink_->on_event(EventPriority::kWarning, "laser: silent or its stream ended; it is brought up again{}", 0);
    case LrfEventType::kResync:
    case LrfEventType::kRejected:
      return;  // counted
  }
}

void LrfSource::add_counts(SourceHealth& health) const {
  const LrfCounters& counters = session_->counters();
  health.rejected += static_cast<std::int64_t>(counters.rejected);
  health.resyncs += static_cast<std::int64_t>(counters.resyncs);
  health.reconnects += std::max<std::int64_t>(opened_ - 1, 0);
}

}  // namespace odoless
