#include "drivers/lrf/csv/csv_session.hpp"

namespace odoless {
namespace {

constexpr std::size_t kRangeMaxBytes = 24;  ///< with its comma
constexpr std::size_t kHeadMaxBytes = 256;

}  // namespace

CsvSession::CsvSession(const LrfParams& params, int beams_max)
    : StreamingSession(params, beams_max),
      reader_(static_cast<std::size_t>(beams_max) * kRangeMaxBytes + kHeadMaxBytes) {}

void CsvSession::receive(std::span<const std::byte> bytes, std::int64_t arrival_ns, LrfSink& sink) {
  using Outcome = csv::LineReader::Outcome;
  counts().bytes += bytes.size();
  for (Outcome outcome = reader_.take(bytes); outcome != Outcome::kMore; outcome = reader_.take(bytes)) {
    if (outcome == Outcome::kLine) {
      on_line(arrival_ns, sink);
    } else if (ready()) {
      ++counts().resyncs;
      sink.on_event({.type = LrfEventType::kResync, .reason = Errc::kFrameTooLong});
    }
  }
}

void CsvSession::on_line(std::int64_t arrival_ns, LrfSink& sink) {
  if (!ready()) {
    bring_up().on_line(reader_.line(), arrival_ns, sink);
    if (ready()) {
      on_ready(arrival_ns, sink);
    }
    return;
  }
  const Result<csv::ScanLine> line = stream().read(reader_.line());
  const Result<LrfScan> scan = line.ok() ? stream().scan(line.value(), arrival_ns) : Result<LrfScan>(line.error());
  counts().clock_resets = stream().clock_resets();
  if (scan.ok()) {
    pass_on(scan.value(), sink);
  } else {
    refuse(scan.error(), arrival_ns, sink);
  }
}

}  // namespace odoless
