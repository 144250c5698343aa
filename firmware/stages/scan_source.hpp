#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

#include "core/base/result.hpp"
#include "core/scan/scan_frame.hpp"
#include "firmware/records/health.hpp"
#include "firmware/records/records.hpp"
#include "rt/clock.hpp"
#include "rt/event_ring.hpp"

namespace odoless {

/// A line for the log with at most one number, `{}` in the text; a string literal.
using EventText = fmt::format_string<std::int64_t>;

/// Takes what a source has found, in order. Real time: called on the sensor thread.
class ScanSink {
 public:
  virtual void on_scan(const RawScan& scan) = 0;
  /// From a matcher elsewhere.
  virtual void on_motion(const Motion& motion) = 0;
  /// Bytes as they were on the wire; of a CAN bus a line of candump.
  virtual void on_raw(RawLine line, std::span<const std::byte> bytes, bool to_device) = 0;
  virtual void on_tilt(const TiltRecord& tilt) = 0;
  virtual void on_event(EventPriority priority, EventText text, std::int64_t number) = 0;

 protected:
  ~ScanSink() = default;
};

/// Where scans come from: a laser, an LCM channel, a recorded log. The sensor thread waits for its descriptor or its
/// deadline and then lets it work.
///
/// Thread: the sensor thread. Real time: no allocation, no lock; `work` may read and write its descriptor and no more.
class ScanSource {
 public:
  static constexpr std::int64_t kNever_ns = std::numeric_limits<std::int64_t>::max();

  ScanSource() = default;
  ScanSource(const ScanSource&) = delete;
  ScanSource& operator=(const ScanSource&) = delete;
  virtual ~ScanSource() = default;

  /// To be waited for; -1: none now.
  [[nodiscard]] virtual int descriptor() const = 0;
  /// When `work` is to be called although nothing came.
  [[nodiscard]] virtual std::int64_t next_deadline_ns() const = 0;
  /// Reads what waits. What came is stamped with the time after it was read, so that nothing arrives early, however
  /// long the thread was held up before.
  virtual void work(const Clock& clock, ScanSink& sink) = 0;

  /// Whether scans can come: the device is open, the socket joined.
  [[nodiscard]] virtual bool is_open() const = 0;
  /// Whether scans bear the time of now, so that late ones can be told.
  [[nodiscard]] virtual bool is_live() const { return true; }
  /// No scan will come any more: a recorded log is at its end.
  [[nodiscard]] virtual bool is_exhausted() const { return false; }
  /// Adds what the source itself counts: rejected, resyncs, reconnects, datagrams lost.
  virtual void add_counts(SourceHealth& health) const = 0;
};

}  // namespace odoless
