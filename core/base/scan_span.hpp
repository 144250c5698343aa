#pragma once

#include <algorithm>
#include <cstdint>

namespace odoless {

/// Time from scan to scan, where scans count by the time that they stand for. Stamps that are the same or run backwards
/// stand for next to nothing, and a hole in the scans says no more than a slow laser would.
///
/// Thread: owned by one thread. Real time: no allocation, constant time.
class ScanSpan {
 public:
  static constexpr double kMax_s = 0.25;  ///< most that one scan stands for

  /// From the last scan to this one, within the bounds; the least before the second.
  double next_s(std::int64_t stamp_ns) {
    const double span_s = started_ ? 1e-9 * static_cast<double>(stamp_ns - stamp_ns_) : 0.0;
    stamp_ns_ = stamp_ns;
    started_ = true;
    return std::clamp(span_s, kMin_s, kMax_s);
  }

 private:
  static constexpr double kMin_s = 0.005;

  std::int64_t stamp_ns_ = 0;
  bool started_ = false;
};

}  // namespace odoless
