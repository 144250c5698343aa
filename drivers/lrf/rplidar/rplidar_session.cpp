#include "drivers/lrf/rplidar/rplidar_session.hpp"

namespace odoless {
namespace {

constexpr std::int64_t kSpinUpNs = 2'000'000'000;  ///< until the motor turns evenly

}  // namespace

RplidarSession::RplidarSession(const LrfParams& params, int beams_max) : StreamingSession(params, beams_max) {}

void RplidarSession::receive(std::span<const std::byte> bytes, std::int64_t arrival_ns, LrfSink& sink) {
  counts().bytes += bytes.size();
  if (!ready()) {
    bring_up().receive(bytes, arrival_ns, sink);
    count_device_errors();
    if (!ready()) {
      return;
    }
    on_ready(arrival_ns + kSpinUpNs, sink);
  }
  for (;;) {
    const rplidar::ScanStream::Found found = stream().take(bytes, arrival_ns);
    if (!found.scan && found.error == Errc::kOk) {
      return;
    }
    on_found(found, sink);
  }
}

void RplidarSession::on_found(const rplidar::ScanStream::Found& found, LrfSink& sink) {
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
