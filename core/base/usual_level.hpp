#pragma once

#include <algorithm>

namespace odoless {

/// What a figure of the scans has lately been like: their mean, older ones counting less. Nothing is usual before it
/// has been seen for a while.
///
/// Thread: owned by one thread. Real time: no allocation, constant time.
class UsualLevel {
 public:
  /// @param span_s  Time that the scan stands for.
  void add(double value, double span_s) {
    level_ = seen_s_ > 0.0 ? level_ + (value - level_) * std::min(1.0, span_s / kMemory_s) : value;
    seen_s_ += span_s;
  }

  /// 0 until then.
  [[nodiscard]] double value() const { return seen_s_ >= kMemory_s ? level_ : 0.0; }

 private:
  static constexpr double kMemory_s = 5.0;

  double level_ = 0.0;
  double seen_s_ = 0.0;
};

}  // namespace odoless
