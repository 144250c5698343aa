#include "drivers/lrf/ldrobot/ldrobot_session.hpp"

namespace odoless {
namespace {

constexpr std::int64_t kSpinUpNs = 2'000'000'000;  ///< until the motor turns evenly

}  // namespace

LdrobotSession::LdrobotSession(const LrfParams& params, int beams_max) : StreamingSession(params, beams_max) {}

void LdrobotSession::receive(std::span<const std::byte> bytes, std::int64_t arrival_ns, LrfSink& sink) {
  counts().bytes += bytes.size();
  if (!ready()) {
    bring_up().receive(bytes, arrival_ns, sink);
    if (!ready()) {
      return;
    }
    on_ready(arrival_ns + kSpinUpNs, sink);
  }
  for (;;) {
    const ldrobot::ScanStream::Found found = stream().take(bytes, arrival_ns);
    if (!found.scan && found.error == Errc::kOk) {
      return;
    }
    on_found(found, sink);
  }
}

void LdrobotSession::on_found(const ldrobot::ScanStream::Found& found, LrfSink& sink) {
  if (found.scan) {
    pass_on(*found.scan, sink);
  } else if (found.error == Errc::kFrameMalformed) {
    ++counts().resyncs;
    sink.on_event({.type = LrfEventType::kResync, .reason = found.error});
  } else {
    counts().resyncs += found.error == Errc::kWrongSum ? 1 : 0;
    counts().reject(found.error, sink);
  }
}

}  // namespace odoless
