#pragma once

#include "drivers/lrf/csv/bring_up.hpp"
#include "drivers/lrf/csv/scan_line.hpp"
#include "drivers/lrf/csv/scan_stream.hpp"
#include "drivers/lrf/streaming_session.hpp"

namespace odoless {

/// Lasers of one's own, whose scans come as lines of text (README.md has the format). It sends nothing.
///
/// One damaged byte costs at most two scans, or changes a range. Contract: see LrfSession.
class CsvSession final : public StreamingSession<csv::ScanStream, csv::BringUp> {
 public:
  /// @param beams_max  Most beams of a scan; lines that have more are refused with Errc::kTooManyBeams.
  CsvSession(const LrfParams& params, int beams_max);

  void receive(std::span<const std::byte> bytes, std::int64_t arrival_ns, LrfSink& sink) override;

 private:
  void forget_received() override { reader_.clear(); }
  void on_line(std::int64_t arrival_ns, LrfSink& sink);

  csv::LineReader reader_;
};

}  // namespace odoless
