#include "drivers/lrf/sopas/sopas_session.hpp"

namespace odoless {
namespace {

/// Head, and two echoes and two remissions of at most four digits and a space each.
std::size_t content_bytes_max(int beams_max) { return static_cast<std::size_t>(beams_max) * 5 * 4 + 1024; }

/// Of a stream: the numbers of a telegram in ASCII have more digits or fewer.
std::size_t limit_bytes(std::size_t content_bytes) { return 2 * content_bytes + 256; }

}  // namespace

SopasSession::SopasSession(const LrfParams& params, int beams_max)
    : StreamingSession(params, beams_max), reader_(content_bytes_max(beams_max)) {}

void SopasSession::receive(std::span<const std::byte> bytes, std::int64_t arrival_ns, LrfSink& sink) {
  using Outcome = sopas::TelegramReader::Outcome;
  counts().bytes += bytes.size();
  for (Outcome outcome = reader_.take(bytes); outcome != Outcome::kMore; outcome = reader_.take(bytes)) {
    if (outcome == Outcome::kTelegram) {
      on_telegram(arrival_ns, sink);
    } else if (ready()) {
      ++counts().resyncs;
      if (outcome == Outcome::kWrongSum) {
        counts().reject(Errc::kWrongSum, sink);
      } else {
        sink.on_event({.type = LrfEventType::kResync, .reason = Errc::kFrameMalformed});
      }
    }
  }
}

void SopasSession::on_telegram(std::int64_t arrival_ns, LrfSink& sink) {
  const sopas::Telegram& telegram = reader_.telegram();
  if (ready()) {
    if (telegram.name() == "LMDscandata" && telegram.command() == "sSN") {
      on_scan(stream().read(telegram), arrival_ns, sink);
    }
    return;
  }
  bring_up().on_telegram(telegram, arrival_ns, sink);
  count_device_errors();
  if (ready()) {
    reader_.set_limit(limit_bytes(telegram.content.size()));
    last_status_ = 0;
    on_ready(arrival_ns, sink);
  }
}

void SopasSession::on_scan(const Result<sopas::ScanData>& data, std::int64_t arrival_ns, LrfSink& sink) {
  const Result<LrfScan> scan = data.ok() ? stream().scan(data.value(), arrival_ns) : Result<LrfScan>(data.error());
  counts().clock_resets = stream().clock_resets();
  if (!scan.ok()) {
    return refuse(scan.error(), arrival_ns, sink);
  }
  pass_on(scan.value(), sink);
  on_status(data.value().device_status, sink);
}

void SopasSession::on_status(int device_status, LrfSink& sink) {
  if (device_status != 0 && device_status != last_status_) {
    tell_device_error(sopas::kDeviceStatus + device_status, sink);
  }
  last_status_ = device_status;
}

}  // namespace odoless
