#include "drivers/lrf/rplidar/rplidar_session.hpp"

#include <algorithm>

namespace odoless {
namespace {

constexpr std::int64_t kSpinUpNs = 2'000'000'000;  ///< until the motor turns evenly

}  // namespace

RplidarSession::RplidarSession(const LrfParams& params, int beams_max)
    : stream_(params, beams_max), bring_up_(params, stream_), stall_timeout_ns_(params.stall_timeout_ns) {}

void RplidarSession::start_over(std::int64_t now_ns) {
  counters_.restarts += was_reset_ ? 1 : 0;
  was_reset_ = true;
  bring_up_.start(now_ns, false);
}

void RplidarSession::reset(std::int64_t now_ns) { start_over(now_ns); }

std::int64_t RplidarSession::next_deadline_ns() const {
  return ready() ? last_scan_ns_ + std::max(stall_timeout_ns_, 3 * geometry().period_ns) : bring_up_.deadline_ns();
}

void RplidarSession::tick(std::int64_t now_ns, LrfSink& sink) {
  if (now_ns < next_deadline_ns()) {
    return;
  }
  if (ready()) {
    sink.on_event({.type = LrfEventType::kLost, .reason = Errc::kDeviceSilent});
    start_over(now_ns);
  } else {
    bring_up_.on_deadline(now_ns, sink);
  }
}

void RplidarSession::receive(std::span<const std::byte> bytes, std::int64_t arrival_ns, LrfSink& sink) {
  counters_.bytes += bytes.size();
  if (!ready()) {
    bring_up_.receive(bytes, arrival_ns, sink);
    counters_.device_errors = bring_up_.device_errors();
    if (!ready()) {
      return;
    }
    last_scan_ns_ = arrival_ns + kSpinUpNs;
    sink.on_event({.type = LrfEventType::kReady});
  }
  for (;;) {
    const rplidar::ScanStream::Found found = stream_.take(bytes, arrival_ns);
    if (!found.scan && found.error == Errc::kOk) {
      return;
    }
    on_found(found, arrival_ns, sink);
  }
}

void RplidarSession::on_found(const rplidar::ScanStream::Found& found, std::int64_t arrival_ns, LrfSink& sink) {
  if (found.scan) {
    ++counters_.scans;
    counters_.identical_run = stream_.identical_run();
    counters_.identical += counters_.identical_run > 0 ? 1 : 0;
    last_scan_ns_ = arrival_ns;
    sink.on_scan(*found.scan);
  } else if (found.error == Errc::kFrameMalformed) {
    ++counters_.resyncs;
    sink.on_event({.type = LrfEventType::kResync, .reason = found.error});
  } else {
    counters_.resyncs += found.error == Errc::kWrongSum ? 1 : 0;
    counters_.reject(found.error, sink);
  }
}

}  // namespace odoless
