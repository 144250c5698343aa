#include "drivers/lrf/scip/scip_session.hpp"

namespace odoless {
namespace {

using scip::status;

/// The most data that a scan can be, with the sums of its lines, and the longest echo, status and stamp.
std::size_t reply_bytes_max(std::size_t characters) { return characters * 65 / 64 + 512; }

std::size_t reply_lines_max(std::size_t characters) { return characters / 64 + 16; }

bool is_digit(int c) { return c >= '0' && c <= '9'; }

/// 50 to 97: trouble with the hardware.
bool is_malfunction(scip::Status device_status) {
  const int tens = device_status / 256;
  return is_digit(tens) && tens >= '5' && device_status < status("98");
}

}  // namespace

ScipSession::ScipSession(const LrfParams& params, int beams_max)
    : ScipSession(params, beams_max, scip::format_of(params.reading, beams_max).most_characters()) {}

ScipSession::ScipSession(const LrfParams& params, int beams_max, std::size_t characters_max)
    : StreamingSession(params, beams_max), reader_(reply_bytes_max(characters_max), reply_lines_max(characters_max)) {}

void ScipSession::forget_received() {
  reader_.clear();
  reader_.expect_stream({});
}

void ScipSession::receive(std::span<const std::byte> bytes, std::int64_t arrival_ns, LrfSink& sink) {
  counts().bytes += bytes.size();
  std::string_view rest(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  while (!rest.empty()) {
    if (bring_up().ignores_bytes()) {
      bring_up().on_ignored_bytes(arrival_ns);
      return;
    }
    switch (reader_.take(rest)) {
      case scip::ReplyReader::Outcome::kMore:
        break;
      case scip::ReplyReader::Outcome::kReply:
        on_reply(arrival_ns, sink);
        break;
      case scip::ReplyReader::Outcome::kCut:
        ++counts().resyncs;
        if (ready()) {  // before, it is a rest of what ran, or the bring-up asks again
          reject(Errc::kFrameTruncated, sink);
        }
        break;
    }
  }
}

void ScipSession::on_reply(std::int64_t arrival_ns, LrfSink& sink) {
  if (ready()) {
    on_stream_reply(reader_.reply(), arrival_ns, sink);
    return;
  }
  bring_up().on_reply(reader_.reply(), arrival_ns, sink);
  count_device_errors();
  if (ready()) {
    reader_.expect_stream(stream().echo());
    on_ready(arrival_ns, sink);
  } else if (bring_up().ignores_bytes()) {
    reader_.clear();
  }
}

void ScipSession::on_stream_reply(const scip::Reply& reply, std::int64_t arrival_ns, LrfSink& sink) {
  const Result<LrfScan> scan = stream().scan(reply, arrival_ns);
  counts().clock_resets = stream().clock_resets();
  if (scan.ok()) {
    pass_on(scan.value(), sink);
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
  tell_device_error(device_status, sink);
  if (device_status != status("98")) {  // 98: it has checked itself and goes on
    start_over(now_ns, is_malfunction(device_status));
  }
}

void ScipSession::reject(Errc reason, LrfSink& sink) {
  if (reason != Errc::kWrongEcho) {
    counts().reject(reason, sink);
    return;
  }
  ++counts().rejected;
  ++counts().resyncs;
  sink.on_event({.type = LrfEventType::kResync, .reason = reason});
}

}  // namespace odoless
