#include "drivers/lrf/scip/scip_session.hpp"

#include <algorithm>

namespace odoless {
namespace {

using scip::status;

/// Range and intensity in 3 characters each, the sums of the lines, and the longest echo, status and stamp.
std::size_t reply_bytes_max(int beams_max) { return static_cast<std::size_t>(beams_max) * 6 * 65 / 64 + 512; }

std::size_t reply_lines_max(int beams_max) { return static_cast<std::size_t>(beams_max) * 6 / 64 + 16; }

bool is_digit(int c) { return c >= '0' && c <= '9'; }

/// 50 to 97: trouble with the hardware.
bool is_malfunction(scip::Status device_status) {
  const int tens = device_status / 256;
  return is_digit(tens) && tens >= '5' && device_status < status("98");
}

}  // namespace

ScipSession::ScipSession(const LrfParams& params, int beams_max)
    : reader_(reply_bytes_max(beams_max), reply_lines_max(beams_max)),
      stream_(params, beams_max),
      bring_up_(params, stream_),
      stall_timeout_ns_(params.stall_timeout_ns) {}

void ScipSession::start_over(std::int64_t now_ns, bool with_reset) {
  counters_.restarts += was_reset_ ? 1 : 0;
  was_reset_ = true;
  reader_.clear();
  reader_.expect_stream({});
  bring_up_.start(now_ns, with_reset);
}

void ScipSession::reset(std::int64_t now_ns) { start_over(now_ns, false); }

std::span<const std::byte> ScipSession::transmit() {
  const std::string_view request = bring_up_.take_request();
  return std::as_bytes(std::span(request.data(), request.size()));
}

std::int64_t ScipSession::next_deadline_ns() const {
  return ready() ? last_scan_ns_ + std::max(stall_timeout_ns_, 3 * geometry().period_ns) : bring_up_.deadline_ns();
}

void ScipSession::tick(std::int64_t now_ns, LrfSink& sink) {
  if (now_ns < next_deadline_ns()) {
    return;
  }
  if (ready()) {
    sink.on_event({.type = LrfEventType::kLost, .reason = Errc::kDeviceSilent});
    start_over(now_ns, false);
  } else {
    bring_up_.on_deadline(now_ns, sink);
    reader_.clear();
  }
}

void ScipSession::receive(std::span<const std::byte> bytes, std::int64_t arrival_ns, LrfSink& sink) {
  counters_.bytes += bytes.size();
  std::string_view rest(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  while (!rest.empty()) {
    if (bring_up_.ignores_bytes()) {
      bring_up_.on_ignored_bytes(arrival_ns);
      return;
    }
    switch (reader_.take(rest)) {
      case scip::ReplyReader::Outcome::kMore:
        break;
      case scip::ReplyReader::Outcome::kReply:
        on_reply(arrival_ns, sink);
        break;
      case scip::ReplyReader::Outcome::kCut:
        ++counters_.resyncs;
        reject(Errc::kFrameTruncated, sink);
        break;
    }
  }
}

void ScipSession::on_reply(std::int64_t arrival_ns, LrfSink& sink) {
  if (ready()) {
    on_stream_reply(reader_.reply(), arrival_ns, sink);
    return;
  }
  bring_up_.on_reply(reader_.reply(), arrival_ns, sink);
  counters_.device_errors = stream_device_errors_ + bring_up_.device_errors();
  if (ready()) {
    last_scan_ns_ = arrival_ns;
    reader_.expect_stream(stream_.echo());
    sink.on_event({.type = LrfEventType::kReady});
  } else if (bring_up_.ignores_bytes()) {
    reader_.clear();
  }
}

void ScipSession::on_stream_reply(const scip::Reply& reply, std::int64_t arrival_ns, LrfSink& sink) {
  const Result<LrfScan> scan = stream_.scan(reply, arrival_ns);
  counters_.clock_resets = stream_.clock_resets();
  if (scan.ok()) {
    ++counters_.scans;
    counters_.identical_run = stream_.identical_run();
    counters_.identical += counters_.identical_run > 0 ? 1 : 0;
    last_scan_ns_ = arrival_ns;
    sink.on_scan(scan.value());
  } else if (scan.error() == Errc::kDeviceStatus && reply.lines() == 2) {
    on_device_status(scip::status_of(reply).value(), arrival_ns, sink);
  } else {
    reject(scan.error(), sink);
  }
}

void ScipSession::on_device_status(scip::Status device_status, std::int64_t now_ns, LrfSink& sink) {
  if (device_status == status("00")) {
    return;  // the answer to a request that was sent twice
  }
  ++stream_device_errors_;
  counters_.device_errors = stream_device_errors_ + bring_up_.device_errors();
  sink.on_event({.type = LrfEventType::kDeviceError, .reason = Errc::kDeviceStatus, .device_status = device_status});
  if (device_status != status("98")) {  // 98: it has checked itself and goes on
    start_over(now_ns, is_malfunction(device_status));
  }
}

void ScipSession::reject(Errc reason, LrfSink& sink) {
  if (reason != Errc::kWrongEcho) {
    counters_.reject(reason, sink);
    return;
  }
  ++counters_.rejected;
  ++counters_.resyncs;
  sink.on_event({.type = LrfEventType::kResync, .reason = reason});
}

}  // namespace odoless
