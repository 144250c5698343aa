#pragma once

#include "drivers/lrf/streaming_session.hpp"
#include "drivers/lrf/turn_scans.hpp"

namespace odoless {

/// What the sessions of lasers that turn all the time share: bytes go to the bring-up until it is done, and what it
/// leaves of them to the stream.
template <class Stream, class BringUp>
class TurningSession : public StreamingSession<Stream, BringUp> {
 public:
  void receive(std::span<const std::byte> bytes, std::int64_t arrival_ns, LrfSink& sink) final {
    this->counts().bytes += bytes.size();
    if (!this->ready()) {
      this->bring_up().receive(bytes, arrival_ns, sink);
      this->count_device_errors();
      if (!this->ready()) {
        return;
      }
      this->on_ready(arrival_ns + kSpinUpNs, sink);
    }
    for (;;) {
      const FoundScan found = this->stream().take(bytes, arrival_ns);
      if (!found.scan && found.error == Errc::kOk) {
        return;
      }
      on_found(found, sink);
    }
  }

 protected:
  using StreamingSession<Stream, BringUp>::StreamingSession;

 private:
  static constexpr std::int64_t kSpinUpNs = 2'000'000'000;  ///< until the motor turns evenly

  void forget_received() override {}  // the bring-up does, and each stream begins with nothing

  void on_found(const FoundScan& found, LrfSink& sink) {
    if (found.scan) {
      this->pass_on(*found.scan, sink);
    } else if (found.error == Errc::kFrameMalformed) {
      ++this->counts().resyncs;
      sink.on_event({.type = LrfEventType::kResync, .reason = found.error});
    } else {
      this->counts().resyncs += found.error == Errc::kWrongSum ? 1 : 0;
      this->counts().reject(found.error, sink);
    }
  }
};

}  // namespace odoless
