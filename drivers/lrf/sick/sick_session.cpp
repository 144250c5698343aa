#include "drivers/lrf/sick/sick_session.hpp"

namespace odoless {
namespace {

constexpr std::size_t kPayloadMaxBytes = 812;  ///< a scan of 401 beams; every other message is shorter
constexpr int kSeverityBits = 0x07;
constexpr int kError = 3;
constexpr int kFatal = 4;

}  // namespace

SickSession::SickSession(const LrfParams& params, int beams_max)
    : StreamingSession(params, beams_max), reader_(kPayloadMaxBytes) {}

void SickSession::forget_received() {
  reader_.clear();
  reader_.expect_stream(0);
}

void SickSession::receive(std::span<const std::byte> bytes, std::int64_t arrival_ns, LrfSink& sink) {
  using Outcome = sick::TelegramReader::Outcome;
  counts().bytes += bytes.size();
  for (Outcome outcome = reader_.take(bytes); outcome != Outcome::kMore; outcome = reader_.take(bytes)) {
    if (outcome == Outcome::kTelegram) {
      on_telegram(arrival_ns, sink);
    } else if (outcome == Outcome::kNotUnderstood && !ready()) {
      bring_up().on_nak(arrival_ns);
    } else if (ready() && outcome == Outcome::kWrongSum) {
      ++counts().resyncs;
      counts().reject(Errc::kWrongSum, sink);
    } else if (ready() && outcome == Outcome::kSkipped) {
      ++counts().resyncs;
      sink.on_event({.type = LrfEventType::kResync, .reason = Errc::kFrameMalformed});
    }
  }
}

void SickSession::on_telegram(std::int64_t arrival_ns, LrfSink& sink) {
  if (ready()) {
    on_stream_telegram(reader_.telegram(), arrival_ns, sink);
    return;
  }
  bring_up().on_telegram(reader_.telegram(), arrival_ns, sink);
  count_device_errors();
  if (ready()) {
    last_severity_ = 0;
    reader_.expect_stream(stream().variant().payload_bytes());
    on_ready(arrival_ns, sink);
  }
}

void SickSession::on_stream_telegram(const sick::Telegram& telegram, std::int64_t arrival_ns, LrfSink& sink) {
  if (telegram.command() != sick::kScanReply) {
    if (telegram.command() == sick::kPowerOn) {
      sink.on_event({.type = LrfEventType::kLost, .reason = Errc::kDeviceStatus});
      start_over(arrival_ns, false);
    }
    return;  // the answer to a request that was sent twice
  }
  const Result<LrfScan> scan = stream().scan(telegram, arrival_ns);
  if (!scan.ok()) {
    counts().reject(scan.error(), sink);
    return;
  }
  pass_on(scan.value(), sink);
  on_status(telegram.status(), arrival_ns, sink);
}

void SickSession::on_status(int device_status, std::int64_t now_ns, LrfSink& sink) {
  const int severity = device_status & kSeverityBits;
  const bool is_news = severity != last_severity_;
  last_severity_ = severity;
  if (severity < kError || !is_news) {
    return;
  }
  tell_device_error(device_status, sink);
  if (severity >= kFatal) {
    start_over(now_ns, true);
  }
}

}  // namespace odoless
