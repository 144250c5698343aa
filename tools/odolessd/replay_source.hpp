#pragma once

#include <cstdint>

#include "firmware/stages/scan_source.hpp"
#include "rt/clock.hpp"
#include "tools/log/log_times.hpp"
#include "tools/log/scan_log.hpp"

namespace odoless {

/// A recorded log as a source of the daemon: as fast as the pipeline takes it, or at a multiple of the recorded pace,
/// as far as its stamps tell that.
///
/// Thread: sensor thread. Real time: no allocation.
class ReplaySource final : public ScanSource {
 public:
  /// @param rate      Recorded seconds per second; 0: one scan after the other.
  /// @param start_ns  When the first scan is due, on the daemon's clock.
  ReplaySource(ScanLog log, double rate, std::int64_t start_ns);

  [[nodiscard]] int descriptor() const override { return -1; }
  [[nodiscard]] std::int64_t next_deadline_ns() const override;
  void work(const Clock& clock, ScanSink& sink) override;
  [[nodiscard]] bool is_open() const override { return true; }
  [[nodiscard]] bool is_live() const override { return false; }
  [[nodiscard]] bool is_exhausted() const override { return next_ >= log_.scans.size(); }
  void add_counts(SourceHealth& /*health*/) const override {}

 private:
  ScanLog log_;
  LogTimes times_;
  double rate_;
  std::int64_t start_ns_;
  std::size_t next_ = 0;
};

}  // namespace odoless
