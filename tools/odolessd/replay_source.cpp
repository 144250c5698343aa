#include "tools/odolessd/replay_source.hpp"

#include <utility>

namespace odoless {

ReplaySource::ReplaySource(ScanLog log, double rate, std::int64_t start_ns)
    : log_(std::move(log)), times_(times_of(log_, 1)), rate_(rate), start_ns_(start_ns) {}

std::int64_t ReplaySource::next_deadline_ns() const {
  if (is_exhausted() || rate_ <= 0.0) {
    return 0;
  }
  const std::int64_t since_ns = times_.times[next_].time_ns - times_.times.front().time_ns;
  return start_ns_ + static_cast<std::int64_t>(static_cast<double>(since_ns) / rate_);
}

void ReplaySource::work(const Clock& clock, ScanSink& sink) {
  if (!is_exhausted() && clock.now_ns() >= next_deadline_ns()) {
    sink.on_scan(log_.scans[next_++].raw());
  }
}

}  // namespace odoless
