#include "drivers/lrf/sick/sick_session.hpp"

#include <algorithm>

namespace odoless {
namespace {

constexpr std::size_t kPayloadMaxBytes = 812;  ///< a scan of 401 beams; every other message is shorter
constexpr int kPowerOn = 0x90;
constexpr int kSeverityBits = 0x07;
constexpr int kError = 3;
constexpr int kFatal = 4;

}  // namespace

SickSession::SickSession(const LrfParams& params, int beams_max)
    : reader_(kPayloadMaxBytes),
      stream_(params, beams_max),
      bring_up_(params, stream_),
      stall_timeout_ns_(params.stall_timeout_ns) {}

void SickSession::start_over(std::int64_t now_ns, bool with_reset) {
  counters_.restarts += was_reset_ ? 1 : 0;
  was_reset_ = true;
  reader_.clear();
  reader_.expect_stream(0);
  bring_up_.start(now_ns, with_reset);
}

void SickSession::reset(std::int64_t now_ns) { start_over(now_ns, false); }

std::int64_t SickSession::next_deadline_ns() const {
  return ready() ? last_scan_ns_ + std::max(stall_timeout_ns_, 3 * geometry().period_ns) : bring_up_.deadline_ns();
}

void SickSession::tick(std::int64_t now_ns, LrfSink& sink) {
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

void SickSession::receive(std::span<const std::byte> bytes, std::int64_t arrival_ns, LrfSink& sink) {
  using Outcome = sick::TelegramReader::Outcome;
  counters_.bytes += bytes.size();
  for (Outcome outcome = reader_.take(bytes); outcome != Outcome::kMore; outcome = reader_.take(bytes)) {
    if (outcome == Outcome::kTelegram) {
      on_telegram(arrival_ns, sink);
    } else if (outcome == Outcome::kNotUnderstood && !ready()) {
      bring_up_.on_nak(arrival_ns);
    } else if (ready() && outcome == Outcome::kWrongSum) {
      ++counters_.resyncs;
      counters_.reject(Errc::kWrongSum, sink);
    } else if (ready() && outcome == Outcome::kSkipped) {
      ++counters_.resyncs;
      sink.on_event({.type = LrfEventType::kResync, .reason = Errc::kFrameMalformed});
    }
  }
}

void SickSession::on_telegram(std::int64_t arrival_ns, LrfSink& sink) {
  if (ready()) {
    on_stream_telegram(reader_.telegram(), arrival_ns, sink);
    return;
  }
  bring_up_.on_telegram(reader_.telegram(), arrival_ns, sink);
  counters_.device_errors = stream_device_errors_ + bring_up_.device_errors();
  if (ready()) {
    last_scan_ns_ = arrival_ns;
    last_severity_ = 0;
    reader_.expect_stream(stream_.variant().payload_bytes());
    sink.on_event({.type = LrfEventType::kReady});
  }
}

void SickSession::on_stream_telegram(const sick::Telegram& telegram, std::int64_t arrival_ns, LrfSink& sink) {
  if (telegram.command() != sick::kScanReply) {
    if (telegram.command() == kPowerOn) {
      sink.on_event({.type = LrfEventType::kLost, .reason = Errc::kDeviceStatus});
      start_over(arrival_ns, false);
    }
    return;  // the answer to a request that was sent twice
  }
  const Result<LrfScan> scan = stream_.scan(telegram, arrival_ns);
  if (!scan.ok()) {
    counters_.reject(scan.error(), sink);
    return;
  }
  ++counters_.scans;
  counters_.identical_run = stream_.identical_run();
  counters_.identical += counters_.identical_run > 0 ? 1 : 0;
  last_scan_ns_ = arrival_ns;
  sink.on_scan(scan.value());
  on_status(telegram.status(), arrival_ns, sink);
}

void SickSession::on_status(int device_status, std::int64_t now_ns, LrfSink& sink) {
  const int severity = device_status & kSeverityBits;
  const bool is_news = severity != last_severity_;
  last_severity_ = severity;
  if (severity < kError || !is_news) {
    return;
  }
  ++stream_device_errors_;
  counters_.device_errors = stream_device_errors_ + bring_up_.device_errors();
  sink.on_event({.type = LrfEventType::kDeviceError, .reason = Errc::kDeviceStatus, .device_status = device_status});
  if (severity >= kFatal) {
    start_over(now_ns, true);
  }
}

}  // namespace odoless
